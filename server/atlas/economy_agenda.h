#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>

#include "common/map/atlas.h"

namespace pangaea {

// Which map is worth economizing: one whose pieces were seen from more than one way, and in which there is clearly more
// than last time that no living agent works on. A value without a thread.
class EconomyAgenda {
 public:
  // `growth`: the share by which those keyframes have to have become more. Where no agent works on the map any more,
  // any is enough.
  // `patience`: one that welds have cancelled so often in a row is let finish.
  EconomyAgenda(double growth, int patience) : growth_(growth), patience_(patience) {}

  // What a server finds when it starts counts as done: doing it again at every start would make maps ever smaller.
  void Recover(const Atlas& atlas);
  // The next one, of `only` this map where one is given; nothing when none is worth it.
  std::optional<MapId> Next(const Atlas& atlas, const std::set<KeyframeId>& in_use, std::optional<MapId> only = {});
  void Start(MapId map) { running_ = map; }
  // A weld changed this map. True: the running economy works on it and has to be cancelled.
  bool MapWelded(MapId map);
  // The running one ended; nothing was done.
  void Cancel() { running_.reset(); }
  // The running one ended with this atlas, or there was nothing to do.
  void Finish(const Atlas& atlas, const std::set<KeyframeId>& in_use);

 private:
  double growth_;
  int patience_;
  std::optional<MapId> running_;
  int cancellations_ = 0;              // since one finished
  std::map<MapId, std::size_t> idle_;  // keyframes that nobody worked on, after the last time
};

}  // namespace pangaea
