#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "common/base/bounded_queue.h"
#include "common/base/result.h"
#include "server/runtime/atlas_jobs.h"
#include "server/runtime/atlas_owner.h"

namespace pangaea {

// The atlas thread with its queue: takes what arrives, in any thread, and gives it to the owner of the atlas in rounds.
// That one thread alone judges, commits, applies and answers is what makes "acknowledged" mean "durable" and "once"
// mean once; while it commits one round, the next one gathers in the queue.
class AtlasService {
 public:
  // Opens and recovers the store. Errors as Store::Open and RecoverAtlas.
  static Result<std::unique_ptr<AtlasService>> Open(const std::filesystem::path& store, const std::string& site,
                                                    const ServiceOptions& options);
  ~AtlasService();
  AtlasService(const AtlasService&) = delete;
  AtlasService& operator=(const AtlasService&) = delete;

  void Start(ServiceOutput output);
  // Finishes what was submitted, answers it, and ends the threads.
  void Stop();

  // Any thread. Waits while the queue is full; what comes after Stop() is dropped (it was never acknowledged).
  void Submit(IngestInput input);
  // Any thread; waits while the queue is full. `answer` is called once, on the atlas thread, when the edits are durable
  // and State() has them, or when they are not taken: kUnavailable while the store is full and after Stop().
  using Answer = std::function<void(const ProposalAnswer&)>;
  void Propose(EditsProposed proposal, Answer answer);
  // Any thread but the atlas thread: proposes and waits for the answer.
  ProposalAnswer ProposeAndWait(EditsProposed proposal);
  // Any thread: acknowledges to every living session once more what it has; acks carry more than numbers. False, and
  // nothing happens, while the queue is full.
  bool AcknowledgeAgain();
  // Any thread but the atlas thread: takes a cause back (server/storage/undo.h) and goes on with the atlas without it.
  // Nothing that was planned on the atlas before may be proposed afterwards: stop the work on it first. Errors as
  // UndoCause; kUnavailable after Stop() and while the store takes nothing.
  Result<UndoReport> Undo(const std::string& cause);
  // Any thread: kept in the store with what is committed next, at the next Tick at the latest.
  void Note(WorkTime time) { owner_->Note(std::move(time)); }
  // Any thread, about once a second: the sizes in the state are measured anew, and a full store is tried again.
  void Tick();
  // Any thread: changes the store's quota, in order with what was submitted.
  void SetStoreQuota(std::uint64_t max_bytes);

  // Any thread, as of AtlasOwner.
  std::shared_ptr<const ServiceState> State() const { return owner_->State(); }
  SnapshotReport LastSnapshot() const { return owner_->LastSnapshot(); }
  std::size_t queued() const { return queue_.size(); }
  std::uint64_t incarnation() const { return owner_->incarnation(); }
  const std::string& site() const { return owner_->site(); }
  // Maps that are not to be merged again.
  const std::vector<std::pair<MapId, MapId>>& separations() const { return owner_->separations(); }
  const ServiceOptions& options() const { return owner_->options(); }
  const std::filesystem::path& store_path() const { return owner_->store_path(); }

 private:
  explicit AtlasService(std::unique_ptr<AtlasOwner> owner);
  void Run();
  std::vector<AtlasJob> NextRound(AtlasJob first);

  const std::unique_ptr<AtlasOwner> owner_;
  BoundedQueue<AtlasJob> queue_;
  std::thread thread_;
};

}  // namespace pangaea
