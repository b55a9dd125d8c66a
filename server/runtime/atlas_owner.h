#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/base/published.h"
#include "common/base/result.h"
#include "common/wire/atlas_event.h"
#include "common/wire/edit_ack.h"
#include "server/ingest/ingest_round.h"
#include "server/runtime/atlas_jobs.h"
#include "server/runtime/latency_window.h"
#include "server/runtime/noted_times.h"
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

// Where the results go. Called on the atlas thread; none may wait for long. State() has what an ack or event speaks of
// by the time either goes out.
struct ServiceOutput {
  std::function<void(const EditAck&)> acknowledge;
  std::function<void(const AtlasEvent&)> report;
  std::function<void()> changed;           // there is a new state
  std::function<void(const Error&)> fail;  // the service cannot go on: stop the server
};

// The atlas of one site with its store: judges, commits, adopts and answers, round by round. Nothing is answered before
// it is durable. Belongs to one thread, the atlas thread; what other threads may call says so.
class AtlasOwner {
 public:
  // Opens and recovers the store. Errors as Store::Open and RecoverAtlas.
  static Result<std::unique_ptr<AtlasOwner>> Open(const std::filesystem::path& store, const std::string& site,
                                                  const ServiceOptions& options);

  // Before the first round.
  void Start(ServiceOutput output);
  // After the last one: stores what is still waiting.
  void Stop();

  // One round. While the store takes nothing, proposals are declined with kUnavailable, and envelopes are forgotten:
  // their agents have them.
  void Run(std::vector<AtlasJob> jobs);
  // See AtlasService::Undo.
  Result<UndoReport> TakeBack(const std::string& cause);

  // Any thread: kept in the store with what is committed next.
  void Note(WorkTime time) { times_.Note(std::move(time)); }
  // Any thread.
  std::shared_ptr<const ServiceState> State() const { return state_.Get(); }
  SnapshotReport LastSnapshot() const { return snapshots_->Report(); }
  std::uint64_t incarnation() const { return incarnation_; }
  const std::string& site() const { return site_; }
  // Maps that are not to be merged again.
  const std::vector<std::pair<MapId, MapId>>& separations() const { return separations_; }
  const ServiceOptions& options() const { return options_; }
  const std::filesystem::path& store_path() const { return store_.path(); }

 private:
  AtlasOwner(Store store, RecoveredAtlas recovered, std::uint64_t incarnation, std::string site,
             std::unique_ptr<SnapshotThread> snapshots, const ServiceOptions& options);
  // Makes the store's atlas the current one.
  Status Reload();
  void LookAfterStore(const std::vector<AtlasJob>& jobs);
  void TryStoreAgain();
  IngestOutcome Judge(std::vector<AtlasJob>& jobs) const;
  Status Commit(const JournalBatch& batch);
  void Adopt(IngestOutcome outcome);
  void AdoptWithoutStore(std::vector<AtlasJob>& jobs, const std::string& error);
  void AcknowledgeLiving();
  void Report(AtlasEvent event);
  void PublishState();

  const std::string site_;
  const ServiceOptions options_;
  const std::uint64_t incarnation_;
  const std::vector<std::pair<MapId, MapId>> separations_;
  Published<ServiceState> state_;
  NotedTimes times_;

  Store store_;
  ServiceState current_;
  std::vector<SessionId> unsaved_;  // sessions whose records changed while the store was full
  bool failed_ = false;             // the service cannot go on
  ServiceOutput output_;
  std::unique_ptr<SnapshotThread> snapshots_;
};

}  // namespace pangaea
