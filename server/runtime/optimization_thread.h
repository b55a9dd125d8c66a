#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <stop_token>
#include <thread>
#include <vector>

#include "common/base/mutex.h"
#include "server/atlas/economy_agenda.h"
#include "server/atlas/map_economy.h"
#include "server/atlas/optimization_agenda.h"
#include "server/atlas/welding_edits.h"
#include "server/fusion/look_memory.h"
#include "server/runtime/atlas_service.h"
#include "server/runtime/bell.h"
#include "server/runtime/work_report.h"

namespace pangaea {

// Runs the global bundle adjustments, one at a time, at the lowest priority, each on a snapshot. A weld in its map
// cancels the running one; its successor starts from what the weld made. When one came to its end, and when none is
// due, it makes the maps smaller; welds cancel that, too.
class OptimizationThread {
 public:
  // A long computation on a snapshot; nothing when the stop was requested, or when it found nothing better. `before`:
  // what the last one whose result was taken has seen of the map.
  using Optimizer = std::function<std::optional<OptimizedMap>(const Atlas& snapshot, MapId map,
                                                              const LookedAtMap& before, std::stop_token stop)>;
  // What the atlas can do without; nothing while there is room for all of it.
  using Tidier = std::function<std::vector<MapEdit>(const IngestState& snapshot, std::stop_token stop)>;
  // What living agents work on.
  using InUse = std::function<std::set<KeyframeId>(const IngestState& snapshot)>;
  // What the map needs no longer; nothing when the stop was requested. `before` as above, of economy.
  using Economizer =
      std::function<std::optional<MapEconomy>(const Atlas& snapshot, MapId map, const std::set<KeyframeId>& in_use,
                                              const LookedAtMap& before, std::stop_token stop)>;
  struct Jobs {
    Optimizer optimize;
    Tidier tidy;
    InUse in_use;
    Economizer economize;  // none: maps stay as large as they are
  };
  // `finished`: a bundle adjustment came to its end or was cancelled. Called on its thread.
  OptimizationThread(AtlasService& service, Jobs jobs, const OptimizationAgendaOptions& options,
                     std::function<void()> finished, WorkLedger& ledger);
  ~OptimizationThread() { Stop(); }

  void Start();
  void RequestStop() { thread_.request_stop(); }
  // Gives up what is running.
  void Stop();
  // Any thread: a weld changed these maps, the second of which may be none.
  void Welded(MapId map, MapId absorbed) EXCLUDES(mutex_);
  // Any thread: there is a new atlas.
  void Notify() { bell_.Ring(); }
  // Any thread.
  bool HoldsLoops(MapId map) const EXCLUDES(mutex_);

 private:
  void Run(const std::stop_token& stop);
  // What is due. False: there is nothing more to do before the bell rings again.
  bool Work(const std::stop_token& stop);
  std::optional<MapId> Begin(const IngestState& state) EXCLUDES(mutex_);
  // What agents closed since the last time.
  void TakeIn(const IngestState& state) REQUIRES(mutex_);
  // False: it was cancelled.
  bool Optimize(const Atlas& snapshot, MapId map, const std::stop_token& stop) EXCLUDES(mutex_);
  void Propose(MapId map, OptimizedMap optimized);
  bool Economize(const IngestState& snapshot, std::optional<MapId> only, const std::stop_token& stop) EXCLUDES(mutex_);
  std::optional<MapId> BeginEconomy(const Atlas& snapshot, const std::set<KeyframeId>& in_use,
                                    std::optional<MapId> only) EXCLUDES(mutex_);
  std::optional<MapEconomy> EconomizeOne(const Atlas& snapshot, MapId map, const std::set<KeyframeId>& in_use,
                                         const std::stop_token& stop) EXCLUDES(mutex_);
  bool Take(const MapEconomy& economy);
  void Tidy(const IngestState& snapshot, const std::stop_token& stop);
  std::stop_source Running() const EXCLUDES(mutex_);

  AtlasService& service_;
  const Jobs jobs_;
  const std::function<void()> finished_;
  WorkLedger& ledger_;
  Bell bell_;
  mutable Mutex mutex_;
  OptimizationAgenda agenda_ GUARDED_BY(mutex_);
  std::stop_source running_ GUARDED_BY(mutex_);
  EconomyAgenda economy_agenda_ GUARDED_BY(mutex_);
  std::map<SessionId, std::uint64_t> closed_maps_ GUARDED_BY(mutex_);  // seen, of each session
  // Of the thread. A restart of it, as an undo makes one, looks at everything once more.
  LookMemory looked_at_;
  LookMemory economized_;
  std::size_t tidied_keyframes_ = 0;  // there were when it was tidied; of the thread
  std::jthread thread_;
};

}  // namespace pangaea
