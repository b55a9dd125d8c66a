#include "server/runtime/atlas_service.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <future>
#include <utility>

#include "server/runtime/unix_clock.h"

namespace pangaea {
namespace {

double MillisecondsSince(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

std::size_t BytesOf(const IngestInput& input) {
  const auto* envelope = std::get_if<EnvelopeArrived>(&input);
  return envelope == nullptr ? 0 : envelope->envelope.edits.size();
}

IngestState StateOf(const RecoveredAtlas& recovered) {
  IngestState state;
  state.atlas = recovered.atlas;
  state.position = recovered.position;
  state.correction = recovered.correction;
  for (const SessionRecord& record : recovered.sessions) {
    state.sessions.emplace(record.announcement.session, IngestSession(record));
  }
  for (const auto& [session, rejection] : recovered.rejections) {
    const auto found = state.sessions.find(session);
    if (found != state.sessions.end()) found->second.RememberRejection(rejection);
  }
  return state;
}

}  // namespace

Result<std::unique_ptr<AtlasService>> AtlasService::Open(const std::filesystem::path& path, const std::string& site,
                                                         const ServiceOptions& options) {
  if (auto status = options.Check(); !status) return tl::make_unexpected(status.error());
  auto store = Store::Open(path, site, options.store);
  if (!store) return tl::make_unexpected(store.error());
  auto recovered = RecoverAtlas(*store);
  if (!recovered) return tl::make_unexpected(recovered.error());
  const auto incarnation = store->BeginIncarnation();
  if (!incarnation) return tl::make_unexpected(incarnation.error());
  auto snapshots = SnapshotStore::Open(path, options.store.max_bytes, options.retention);
  if (!snapshots) return tl::make_unexpected(snapshots.error());
  const SnapshotTriggers triggers{options.snapshot_envelopes, options.snapshot_bytes};
  auto thread = std::make_unique<SnapshotThread>(std::move(*snapshots), triggers, recovered->snapshot_position,
                                                 recovered->replayed);
  return std::unique_ptr<AtlasService>(
      new AtlasService(std::move(*store), std::move(*recovered), *incarnation, site, std::move(thread), options));
}

AtlasService::AtlasService(Store store, RecoveredAtlas recovered, std::uint64_t incarnation, std::string site,
                           std::unique_ptr<SnapshotThread> snapshots, const ServiceOptions& options)
    : site_(std::move(site)),
      options_(options),
      incarnation_(incarnation),
      separations_(std::move(recovered.separations)),
      queue_(options.queue_capacity),
      state_(std::make_shared<const ServiceState>()),
      store_(std::move(store)),
      snapshots_(std::move(snapshots)) {
  current_.ingest = StateOf(recovered);
  PublishState();
}

AtlasService::~AtlasService() { Stop(); }

void AtlasService::Start(ServiceOutput output) {
  output_ = std::move(output);
  snapshots_->Start();
  thread_ = std::thread([this] { Run(); });
}

void AtlasService::Stop() {
  queue_.Close();
  if (thread_.joinable()) thread_.join();
  JournalBatch last;
  last.work_times = TakeTimes();
  if (!failed_) (void)Commit(last);
  snapshots_->Stop();
}

void AtlasService::Submit(IngestInput input) { (void)queue_.Push(Arrival{std::move(input), Clock::now()}); }

void AtlasService::Propose(EditsProposed proposal, Answer answer) {
  // The queue destroys what it does not take.
  if (!queue_.Push(Proposed{std::move(proposal), answer})) answer(Fail(ErrorCode::kUnavailable, "the server stops"));
}

ProposalAnswer AtlasService::ProposeAndWait(EditsProposed proposal) {
  std::promise<ProposalAnswer> promise;
  Propose(std::move(proposal), [&promise](const ProposalAnswer& answer) { promise.set_value(answer); });
  return promise.get_future().get();
}

Result<UndoReport> AtlasService::Undo(const std::string& cause) {
  std::promise<Result<UndoReport>> promise;
  const auto answer = [&promise](const Result<UndoReport>& report) { promise.set_value(report); };
  if (!queue_.Push(UndoWanted{cause, answer})) return Fail(ErrorCode::kUnavailable, "the server stops");
  return promise.get_future().get();
}

void AtlasService::Note(WorkTime time) {
  constexpr std::size_t kMostWaiting = 10'000;  // while the store takes nothing
  MutexLock lock(times_mutex_);
  if (times_.size() < kMostWaiting) times_.push_back(std::move(time));
}

std::vector<WorkTime> AtlasService::TakeTimes() {
  MutexLock lock(times_mutex_);
  return std::exchange(times_, {});
}

void AtlasService::Tick() { (void)queue_.TryPush(Ticked{}); }

void AtlasService::AcknowledgeAgain() { (void)queue_.TryPush(AckWanted{}); }

void AtlasService::SetStoreQuota(std::uint64_t max_bytes) { (void)queue_.Push(NewQuota{max_bytes}); }

void AtlasService::Run() {
  while (auto job = queue_.Pop()) {
    if (const auto* undo = std::get_if<UndoWanted>(&*job)) {
      undo->answer(TakeBack(undo->cause));
      continue;
    }
    std::vector<Job> jobs = NextJobs(std::move(*job));
    std::vector<UndoWanted> undos;
    for (Job& wanted : jobs) {
      if (auto* undo = std::get_if<UndoWanted>(&wanted)) undos.push_back(std::move(*undo));
    }
    if (failed_) {
      Decline(jobs, "the server cannot go on");
    } else {
      RunRound(std::move(jobs));
    }
    for (const UndoWanted& undo : undos) undo.answer(TakeBack(undo.cause));
  }
}

Result<UndoReport> AtlasService::TakeBack(const std::string& cause) {
  if (failed_) return Fail(ErrorCode::kUnavailable, "the server cannot go on");
  if (!current_.store_error.empty()) {
    return Fail(ErrorCode::kUnavailable, "the store takes nothing: " + current_.store_error);
  }
  // It writes to the same store, and what it has to write may be what is taken back.
  snapshots_->Stop();
  auto report = UndoCause(store_, cause, UnixNanoseconds());
  if (const Status reloaded = Reload(); !reloaded) {
    failed_ = true;
    output_.fail(reloaded.error());
    return tl::make_unexpected(reloaded.error());
  }
  if (!report) return report;
  current_.ingest.correction = std::max(current_.ingest.correction, report->position);
  PublishState();
  Report({{}, AtlasEventKind::kUndone, Describe(cause, *report), 0, 0});
  output_.changed();
  return report;
}

Status AtlasService::Reload() {
  auto snapshots = SnapshotStore::Open(store_.path(), options_.store.max_bytes, options_.retention);
  if (!snapshots) return tl::make_unexpected(snapshots.error());
  auto recovered = RecoverAtlas(store_);
  if (!recovered) return tl::make_unexpected(recovered.error());
  current_.ingest.atlas = std::move(recovered->atlas);
  current_.ingest.position = recovered->position;
  snapshots_->Restart(std::move(*snapshots), recovered->snapshot_position);
  return {};
}

std::vector<AtlasService::Job> AtlasService::NextJobs(Job first) {
  std::vector<Job> jobs;
  std::size_t bytes = 0;
  for (std::optional<Job> job(std::move(first)); job; job = queue_.TryPop()) {
    if (const auto* arrival = std::get_if<Arrival>(&*job)) bytes += BytesOf(arrival->input);
    jobs.push_back(std::move(*job));
    if (jobs.size() >= options_.round_envelopes || bytes >= options_.round_bytes) break;
  }
  return jobs;
}

void AtlasService::RunRound(std::vector<Job> jobs) {
  LookAfterStore(jobs);
  if (!current_.store_error.empty()) return AdoptWithoutStore(jobs, current_.store_error);
  const std::vector<Clock::time_point> arrivals = EnvelopeArrivals(jobs);
  IngestOutcome outcome = JudgeRound(jobs);
  outcome.batch.work_times = TakeTimes();
  const Status stored = Commit(outcome.batch);
  if (!stored && stored.error().code == ErrorCode::kUnavailable) {
    return AdoptWithoutStore(jobs, stored.error().message);
  }
  if (!stored) {
    failed_ = true;
    Decline(jobs, stored.error().message);
    return output_.fail(stored.error());
  }
  unsaved_.clear();
  for (const auto arrival : arrivals) current_.acknowledge_ms.Add(MillisecondsSince(arrival));
  std::vector<ProposalAnswer> answers = std::move(outcome.answers);
  Adopt(std::move(outcome));
  AnswerProposals(jobs, answers);
  if (std::ranges::any_of(jobs, [](const Job& job) { return std::holds_alternative<AckWanted>(job); })) {
    AcknowledgeLiving();
  }
  if (HasInput(jobs)) output_.changed();
}

void AtlasService::LookAfterStore(const std::vector<Job>& jobs) {
  for (const Job& job : jobs) {
    if (const auto* quota = std::get_if<NewQuota>(&job)) {
      if (const auto status = store_.SetMaxBytes(quota->max_bytes); !status) spdlog::warn(status.error().message);
    }
    if (!std::holds_alternative<Ticked>(job)) continue;
    current_.store = store_.Size();
    if (!current_.store_error.empty()) TryStoreAgain();
  }
}

// What was forgotten meanwhile comes again by itself: the agents' patience with unacknowledged envelopes is limited.
void AtlasService::TryStoreAgain() {
  if (const auto status = store_.Probe(); !status) return;
  current_.store_error.clear();
  PublishState();
  Report({{}, AtlasEventKind::kStoreRecovered, "the store takes writes again", 0, 0});
  output_.changed();
}

IngestOutcome AtlasService::JudgeRound(std::vector<Job>& jobs) const {
  IngestRound round(current_.ingest, options_.ingest, UnixNanoseconds());
  for (Job& job : jobs) {
    if (auto* arrival = std::get_if<Arrival>(&job)) {
      std::visit([&round](auto&& input) { round.Take(std::move(input)); }, std::move(arrival->input));
    } else if (auto* proposed = std::get_if<Proposed>(&job)) {
      round.Take(std::move(proposed->proposal));
    }
  }
  return std::move(round).Finish(unsaved_);
}

Status AtlasService::Commit(const JournalBatch& batch) {
  if (batch.empty()) return {};
  const auto begin = Clock::now();
  Status status = store_.Append(batch);
  current_.commit_ms.Add(MillisecondsSince(begin));
  return status;
}

void AtlasService::Adopt(IngestOutcome outcome) {
  current_.ingest = std::move(outcome.state);
  std::uint64_t bytes = 0;
  for (const JournalEntry& entry : outcome.batch.entries) bytes += entry.envelope.edits.size();
  for (const ServerEdits& edits : outcome.batch.server_edits) bytes += edits.edits.size();
  const std::size_t entries = outcome.batch.entries.size() + outcome.batch.server_edits.size();
  for (KeptAtlas& kept : outcome.kept) snapshots_->Keep(std::move(kept.atlas), kept.position);
  snapshots_->Committed(current_.ingest.atlas, current_.ingest.position, entries, bytes);
  PublishState();
  for (EditAck& ack : outcome.acks) {
    ack.server_incarnation = incarnation_;
    output_.acknowledge(ack);
  }
  for (AtlasEvent& event : outcome.events) Report(std::move(event));
}

void AtlasService::AdoptWithoutStore(std::vector<Job>& jobs, const std::string& error) {
  if (current_.store_error.empty()) {
    spdlog::error("the store takes nothing: {}; nothing is acknowledged until it does", error);
    current_.store_error = error;
    PublishState();
    Report({{}, AtlasEventKind::kStoreFailed, error, 0, 0});
  }
  Decline(jobs, "the store takes nothing: " + error);
  std::erase_if(jobs, [](const Job& job) {
    const auto* arrival = std::get_if<Arrival>(&job);
    return arrival == nullptr || std::holds_alternative<EnvelopeArrived>(arrival->input);
  });
  IngestOutcome outcome = JudgeRound(jobs);
  unsaved_.clear();
  for (const SessionRecord& record : outcome.batch.sessions) unsaved_.push_back(record.announcement.session);
  Adopt(std::move(outcome));
  output_.changed();
}

void AtlasService::AcknowledgeLiving() {
  for (const auto& [id, session] : current_.ingest.sessions) {
    if (!session.alive()) continue;
    output_.acknowledge({id, session.record().acknowledged, incarnation_, session.RecentRejections()});
  }
}

void AtlasService::AnswerProposals(const std::vector<Job>& jobs, const std::vector<ProposalAnswer>& answers) {
  auto answer = answers.begin();
  for (const Job& job : jobs) {
    if (const auto* proposed = std::get_if<Proposed>(&job)) proposed->answer(*answer++);
  }
}

void AtlasService::Decline(const std::vector<Job>& jobs, const std::string& why) {
  for (const Job& job : jobs) {
    if (const auto* proposed = std::get_if<Proposed>(&job)) proposed->answer(Fail(ErrorCode::kUnavailable, why));
  }
}

std::vector<AtlasService::Clock::time_point> AtlasService::EnvelopeArrivals(const std::vector<Job>& jobs) {
  std::vector<Clock::time_point> arrivals;
  for (const Job& job : jobs) {
    const auto* arrival = std::get_if<Arrival>(&job);
    if (arrival != nullptr && std::holds_alternative<EnvelopeArrived>(arrival->input)) {
      arrivals.push_back(arrival->time);
    }
  }
  return arrivals;
}

bool AtlasService::HasInput(const std::vector<Job>& jobs) {
  return std::ranges::any_of(jobs, [](const Job& job) {
    return std::holds_alternative<Arrival>(job) || std::holds_alternative<Proposed>(job);
  });
}

void AtlasService::Report(AtlasEvent event) {
  event.site = site_;
  event.stamp_ns = UnixNanoseconds();
  output_.report(event);
}

void AtlasService::PublishState() { state_.Set(std::make_shared<const ServiceState>(current_)); }

}  // namespace pangaea
