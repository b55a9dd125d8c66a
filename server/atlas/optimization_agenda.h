#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>

#include "common/base/result.h"
#include "common/map/atlas.h"

namespace pangaea {

// Whether pieces of the map were seen from more than one way: adjusting it as a whole says something that its agent's
// local adjustment did not.
bool IsWelded(const Atlas& atlas, MapId map);

struct OptimizationAgendaOptions {
  // A map of several pieces that has grown by this share since its last global bundle adjustment gets another one.
  double growth = 0.25;
  // A bundle adjustment that welds have cancelled so often in a row is let finish: loops in its map wait for it.
  int patience = 3;
  // An adjustment before which more than this share of the map's landmarks turned out to be duplicates leaves a map
  // that is not settled: better aligned, it shows more of them. Where a session ends it gets so many more, while its
  // agent waits.
  double settled_share = 0.0025;
  int closing_rounds = 3;

  Status Check() const;
};

// Which map's global bundle adjustment is due, and whether the running one still makes sense. Due is a map that was
// welded, that was closed since its last one, or that grew. A value without a thread.
class OptimizationAgenda {
 public:
  explicit OptimizationAgenda(const OptimizationAgendaOptions& options) : options_(options) {}

  // A weld changed this map. True: the running adjustment works on it and has to be cancelled (Finish says so then).
  bool MapWelded(MapId map);
  // Something else changed it so much that it is due again.
  void MapChanged(MapId map) { MakeDue(map); }
  // The session's agent said that nothing more comes to one of its maps. Every welded map with keyframes of it is due
  // that is not what it was at its last adjustment, or that one did not leave settled: the agent waits for what that
  // makes of them.
  void SessionClosedMap(const Atlas& atlas, SessionId session);
  // Looks for maps that are due by themselves, and follows merges.
  void Update(const Atlas& atlas);
  // Starts the one that has waited longest. Nothing while one runs, or when none is due.
  std::optional<MapId> Start(const Atlas& atlas);
  // `done`: false when it was cancelled or failed. A cancelled one is due again. `fused`: duplicates that became one.
  void Finish(bool done, std::size_t fused = 0);
  // Loops in this map have to wait (merges never do).
  bool HoldsLoops(MapId map) const;
  std::optional<MapId> running() const { return running_; }
  std::size_t waiting() const { return due_.size(); }

 private:
  struct Optimized {
    std::size_t keyframes = 0;  // it had then
    std::size_t landmarks = 0;
    bool closed = false;
    bool settled = true;
  };
  void MakeDue(MapId map);

  OptimizationAgendaOptions options_;
  std::map<MapId, std::size_t> due_;  // and when it became due: in this order they start
  std::size_t clock_ = 0;
  std::optional<MapId> running_;
  Optimized at_start_;                  // of the running one
  bool cancelled_ = false;              // the running one
  std::map<MapId, int> cancellations_;  // in a row
  std::map<MapId, Optimized> optimized_;
  std::map<MapId, int> closing_;  // in which a session ended: how many more it may get until it is settled
};

}  // namespace pangaea
