#include "server/runtime/atlas_service.h"

#include <future>
#include <utility>

namespace pangaea {

Result<std::unique_ptr<AtlasService>> AtlasService::Open(const std::filesystem::path& path, const std::string& site,
                                                         const ServiceOptions& options) {
  auto owner = AtlasOwner::Open(path, site, options);
  if (!owner) return tl::make_unexpected(owner.error());
  return std::unique_ptr<AtlasService>(new AtlasService(std::move(*owner)));
}

AtlasService::AtlasService(std::unique_ptr<AtlasOwner> owner)
    : owner_(std::move(owner)), queue_(owner_->options().queue_capacity) {}

AtlasService::~AtlasService() { Stop(); }

void AtlasService::Start(ServiceOutput output) {
  owner_->Start(std::move(output));
  thread_ = std::thread([this] { Run(); });
}

void AtlasService::Stop() {
  queue_.Close();
  if (thread_.joinable()) thread_.join();
  owner_->Stop();
}

void AtlasService::Submit(IngestInput input) {
  (void)queue_.Push(InputJob{std::move(input), std::chrono::steady_clock::now()});
}

void AtlasService::Propose(EditsProposed proposal, Answer answer) {
  // The queue destroys what it does not take.
  if (!queue_.Push(ProposalJob{std::move(proposal), answer})) answer(Fail(ErrorCode::kUnavailable, "the server stops"));
}

ProposalAnswer AtlasService::ProposeAndWait(EditsProposed proposal) {
  std::promise<ProposalAnswer> promise;
  Propose(std::move(proposal), [&promise](const ProposalAnswer& answer) { promise.set_value(answer); });
  return promise.get_future().get();
}

Result<UndoReport> AtlasService::Undo(const std::string& cause) {
  std::promise<Result<UndoReport>> promise;
  const auto answer = [&promise](const Result<UndoReport>& report) { promise.set_value(report); };
  if (!queue_.Push(UndoJob{cause, answer})) return Fail(ErrorCode::kUnavailable, "the server stops");
  return promise.get_future().get();
}

void AtlasService::Tick() { (void)queue_.TryPush(TickJob{}); }

bool AtlasService::AcknowledgeAgain() { return queue_.TryPush(AckJob{}); }

void AtlasService::SetStoreQuota(std::uint64_t max_bytes) { (void)queue_.Push(QuotaJob{max_bytes}); }

void AtlasService::Run() {
  while (auto job = queue_.Pop()) {
    if (const auto* undo = std::get_if<UndoJob>(&*job)) {
      undo->answer(owner_->TakeBack(undo->cause));
      continue;
    }
    std::vector<AtlasJob> jobs = NextRound(std::move(*job));
    const std::vector<UndoJob> undos = TakeUndos(jobs);
    owner_->Run(std::move(jobs));
    for (const UndoJob& undo : undos) undo.answer(owner_->TakeBack(undo.cause));
  }
}

std::vector<AtlasJob> AtlasService::NextRound(AtlasJob first) {
  const ServiceOptions& options = owner_->options();
  std::vector<AtlasJob> jobs;
  std::size_t bytes = 0;
  for (std::optional<AtlasJob> job(std::move(first)); job; job = queue_.TryPop()) {
    bytes += BytesOf(*job);
    jobs.push_back(std::move(*job));
    if (jobs.size() >= options.round_envelopes || bytes >= options.round_bytes) break;
  }
  return jobs;
}

}  // namespace pangaea
