#include "server/runtime/atlas_owner.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "server/runtime/unix_clock.h"

namespace pangaea {
namespace {

double MillisecondsSince(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
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

Result<std::unique_ptr<AtlasOwner>> AtlasOwner::Open(const std::filesystem::path& path, const std::string& site,
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
  return std::unique_ptr<AtlasOwner>(
      new AtlasOwner(std::move(*store), std::move(*recovered), *incarnation, site, std::move(thread), options));
}

AtlasOwner::AtlasOwner(Store store, RecoveredAtlas recovered, std::uint64_t incarnation, std::string site,
                       std::unique_ptr<SnapshotThread> snapshots, const ServiceOptions& options)
    : site_(std::move(site)),
      options_(options),
      incarnation_(incarnation),
      separations_(std::move(recovered.separations)),
      state_(std::make_shared<const ServiceState>()),
      store_(std::move(store)),
      snapshots_(std::move(snapshots)) {
  current_.ingest = StateOf(recovered);
  PublishState();
}

void AtlasOwner::Start(ServiceOutput output) {
  output_ = std::move(output);
  snapshots_->Start();
}

void AtlasOwner::Stop() {
  JournalBatch last;
  last.work_times = times_.Take();
  if (!failed_) (void)Commit(last);
  snapshots_->Stop();
}

void AtlasOwner::Run(std::vector<AtlasJob> jobs) {
  if (failed_) return Decline(jobs, "the server cannot go on");
  LookAfterStore(jobs);
  if (!current_.store_error.empty()) return AdoptWithoutStore(jobs, current_.store_error);
  const std::vector<ArrivalTime> arrivals = EnvelopeArrivals(jobs);
  IngestOutcome outcome = Judge(jobs);
  outcome.batch.work_times = times_.Take();
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
  if (WantsAcks(jobs)) AcknowledgeLiving();
  if (HasInput(jobs)) output_.changed();
}

void AtlasOwner::LookAfterStore(const std::vector<AtlasJob>& jobs) {
  for (const AtlasJob& job : jobs) {
    if (const auto* quota = std::get_if<QuotaJob>(&job)) {
      if (const auto status = store_.SetMaxBytes(quota->max_bytes); !status) spdlog::warn(status.error().message);
    }
    if (!std::holds_alternative<TickJob>(job)) continue;
    current_.store = store_.Size();
    if (!current_.store_error.empty()) TryStoreAgain();
  }
}

// What was forgotten meanwhile comes again by itself: the agents' patience with unacknowledged envelopes is limited.
void AtlasOwner::TryStoreAgain() {
  if (const auto status = store_.Probe(); !status) return;
  current_.store_error.clear();
  PublishState();
  Report({{}, AtlasEventKind::kStoreRecovered, "the store takes writes again", 0, 0});
  output_.changed();
}

IngestOutcome AtlasOwner::Judge(std::vector<AtlasJob>& jobs) const {
  IngestRound round(current_.ingest, options_.ingest, UnixNanoseconds());
  MoveInto(round, jobs);
  return std::move(round).Finish(unsaved_);
}

Status AtlasOwner::Commit(const JournalBatch& batch) {
  if (batch.empty()) return {};
  const auto begin = std::chrono::steady_clock::now();
  Status status = store_.Append(batch);
  current_.commit_ms.Add(MillisecondsSince(begin));
  return status;
}

void AtlasOwner::Adopt(IngestOutcome outcome) {
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

void AtlasOwner::AdoptWithoutStore(std::vector<AtlasJob>& jobs, const std::string& error) {
  if (current_.store_error.empty()) {
    spdlog::error("the store takes nothing: {}; nothing is acknowledged until it does", error);
    current_.store_error = error;
    PublishState();
    Report({{}, AtlasEventKind::kStoreFailed, error, 0, 0});
  }
  Decline(jobs, "the store takes nothing: " + error);
  DropWhatNeedsAStore(jobs);
  IngestOutcome outcome = Judge(jobs);
  unsaved_.clear();
  for (const SessionRecord& record : outcome.batch.sessions) unsaved_.push_back(record.announcement.session);
  Adopt(std::move(outcome));
  output_.changed();
}

void AtlasOwner::AcknowledgeLiving() {
  for (const auto& [id, session] : current_.ingest.sessions) {
    if (!session.alive()) continue;
    output_.acknowledge({id, session.record().acknowledged, incarnation_, session.RecentRejections()});
  }
}

Result<UndoReport> AtlasOwner::TakeBack(const std::string& cause) {
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

Status AtlasOwner::Reload() {
  auto snapshots = SnapshotStore::Open(store_.path(), options_.store.max_bytes, options_.retention);
  if (!snapshots) return tl::make_unexpected(snapshots.error());
  auto recovered = RecoverAtlas(store_);
  if (!recovered) return tl::make_unexpected(recovered.error());
  current_.ingest.atlas = std::move(recovered->atlas);
  current_.ingest.position = recovered->position;
  snapshots_->Restart(std::move(*snapshots), recovered->snapshot_position);
  return {};
}

void AtlasOwner::Report(AtlasEvent event) {
  event.site = site_;
  event.stamp_ns = UnixNanoseconds();
  output_.report(event);
}

void AtlasOwner::PublishState() { state_.Set(std::make_shared<const ServiceState>(current_)); }

}  // namespace pangaea
