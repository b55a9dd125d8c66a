#pragma once

#include <cstdint>
#include <set>
#include <vector>

#include "common/base/result.h"
#include "common/map/atlas.h"

namespace pangaea {

struct SettlingOptions {
  // A keyframe this old (by image stamps) is settled whatever happens: place recognition would starve without it.
  double max_unsettled_seconds = 5.0;
  // The newest keyframes are never settled before that age: local mapping still triangulates with them.
  int window_keyframes = 3;
  // An older keyframe that shares at least this many landmarks with the newest is still in the local window.
  int window_covisibility = 15;

  Status Check() const;
};

// Those of `waiting` (keyframes not sent yet; ids that are gone are skipped) that left the local window, ascending by
// id. All of a closed map have. `newest_stamp_ns` is the stamp of the newest frame: stamps are the only clock here.
std::vector<KeyframeId> SettledKeyframes(const Atlas& atlas, const std::set<KeyframeId>& waiting,
                                         std::int64_t newest_stamp_ns, const SettlingOptions& options);

}  // namespace pangaea
