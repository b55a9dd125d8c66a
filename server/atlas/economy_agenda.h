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
  explicit EconomyAgenda(double growth) : growth_(growth) {}

  // What a server finds when it starts counts as done: doing it again at every start would make maps ever smaller.
  void Recover(const Atlas& atlas);
  // The next one; nothing when none is worth it.
  std::optional<MapId> Next(const Atlas& atlas, const std::set<KeyframeId>& in_use);
  // It was economized, or there was nothing to do: the atlas as it is then.
  void Finish(MapId map, const Atlas& atlas, const std::set<KeyframeId>& in_use);

 private:
  double growth_;
  std::map<MapId, std::size_t> idle_;  // keyframes that nobody worked on, after the last time
};

}  // namespace pangaea
