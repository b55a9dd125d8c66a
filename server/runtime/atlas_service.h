#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "common/base/bounded_queue.h"
#include "common/base/mutex.h"
#include "common/base/published.h"
#include "common/base/result.h"
#include "common/wire/atlas_event.h"
#include "common/wire/edit_ack.h"
#include "server/ingest/ingest_round.h"
#include "server/runtime/latency_window.h"
#include "server/runtime/server_options.h"
#include "server/runtime/snapshot_thread.h"
#include "server/storage/recovery.h"
#include "server/storage/store.h"
#include "server/storage/undo.h"

namespace pangaea {

// What the atlas thread shows of itself after a round.
struct ServiceState {
  IngestState ingest;
  StoreSize store;
  // Why the store takes nothing at the moment; empty while it does. Meanwhile nothing is acknowledged.
  std::string store_error;
  LatencyWindow acknowledge_ms;  // from the arrival of an envelope until its ack may go out
  LatencyWindow commit_ms;
};

// Where the service's results go. Called on the atlas thread; none may wait for long. State() has what an ack or event
// speaks of by the time either goes out.
struct ServiceOutput {
  std::function<void(const EditAck&)> acknowledge;
  std::function<void(const AtlasEvent&)> report;
  std::function<void()> changed;           // there is a new state
  std::function<void(const Error&)> fail;  // the service cannot go on: stop the server
};

// The atlas of one site with its store: takes what arrives, in any thread, and makes it durable before it answers.
// The atlas thread alone judges, commits, applies and answers, round by round, which is what makes "acknowledged" mean
// "durable" and "once" mean once; while it commits one round, the next one gathers in the queue.
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
  // Any thread: acknowledges to every living session once more what it has; acks carry more than numbers.
  void AcknowledgeAgain();
  // Any thread but the atlas thread: takes a cause back (server/storage/undo.h) and goes on with the atlas without it.
  // Nothing that was planned on the atlas before may be proposed afterwards: stop the work on it first. Errors as
  // UndoCause; kUnavailable after Stop() and while the store takes nothing.
  Result<UndoReport> Undo(const std::string& cause);
  // Any thread: kept in the store with what is committed next, at the next Tick at the latest.
  void Note(WorkTime time) EXCLUDES(times_mutex_);
  // Any thread, about once a second: the sizes in the state are measured anew, and a full store is tried again.
  void Tick();
  // Any thread: changes the store's quota, in order with what was submitted.
  void SetStoreQuota(std::uint64_t max_bytes);

  std::shared_ptr<const ServiceState> State() const { return state_.Get(); }
  SnapshotReport LastSnapshot() const { return snapshots_->Report(); }
  std::size_t queued() const { return queue_.size(); }
  std::uint64_t incarnation() const { return incarnation_; }
  const std::string& site() const { return site_; }
  // Maps that are not to be merged again.
  const std::vector<std::pair<MapId, MapId>>& separations() const { return separations_; }
  const ServiceOptions& options() const { return options_; }
  const std::filesystem::path& store_path() const { return store_.path(); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Arrival {
    IngestInput input;
    Clock::time_point time;
  };
  struct Ticked {};
  struct AckWanted {};
  struct NewQuota {
    std::uint64_t max_bytes = 0;
  };
  struct Proposed {
    EditsProposed proposal;
    Answer answer;
  };
  struct UndoWanted {
    std::string cause;
    std::function<void(const Result<UndoReport>&)> answer;
  };
  using Job = std::variant<Arrival, Proposed, Ticked, AckWanted, NewQuota, UndoWanted>;

  AtlasService(Store store, RecoveredAtlas recovered, std::uint64_t incarnation, std::string site,
               std::unique_ptr<SnapshotThread> snapshots, const ServiceOptions& options);
  void Run();
  std::vector<Job> NextJobs(Job first);
  void RunRound(std::vector<Job> jobs);
  Result<UndoReport> TakeBack(const std::string& cause);
  // Makes the store's atlas the current one.
  Status Reload();
  void LookAfterStore(const std::vector<Job>& jobs);
  void TryStoreAgain();
  IngestOutcome JudgeRound(std::vector<Job>& jobs) const;
  Status Commit(const JournalBatch& batch);
  void Adopt(IngestOutcome outcome);
  // The store is full: what needs no store still counts, the envelopes are forgotten (their agents have them).
  void AdoptWithoutStore(std::vector<Job>& jobs, const std::string& error);
  static void AnswerProposals(const std::vector<Job>& jobs, const std::vector<ProposalAnswer>& answers);
  // None of the proposals among the jobs is taken.
  static void Decline(const std::vector<Job>& jobs, const std::string& why);
  void Report(AtlasEvent event);
  void PublishState();
  static std::vector<Clock::time_point> EnvelopeArrivals(const std::vector<Job>& jobs);
  void AcknowledgeLiving();
  static bool HasInput(const std::vector<Job>& jobs);
  std::vector<WorkTime> TakeTimes() EXCLUDES(times_mutex_);

  const std::string site_;
  const ServiceOptions options_;
  const std::uint64_t incarnation_;
  const std::vector<std::pair<MapId, MapId>> separations_;
  BoundedQueue<Job> queue_;
  Published<ServiceState> state_;
  Mutex times_mutex_;
  std::vector<WorkTime> times_ GUARDED_BY(times_mutex_);  // not in the store yet

  // Owned by the atlas thread once it runs.
  Store store_;
  ServiceState current_;
  std::vector<SessionId> unsaved_;  // sessions whose records changed while the store was full
  bool failed_ = false;
  ServiceOutput output_;

  std::unique_ptr<SnapshotThread> snapshots_;
  std::thread thread_;
};

}  // namespace pangaea
