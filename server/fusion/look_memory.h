#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <vector>

#include "common/geometry/rigid3.h"
#include "common/map/atlas.h"

namespace pangaea {

// What a map was like when duplicates were last looked for in it, and how far each thing has crept since it was looked
// at itself (pixels, summed over the looks in between).
struct LookedAtMap {
  struct KeyframeState {
    KeyframeId id;
    Rigid3d camera_from_map;
    double crept = 0.0;  // most of what is in view, in its image
  };
  struct LandmarkState {
    LandmarkId id;
    Eigen::Vector3d point_in_map;
    std::uint32_t observers = 0;  // count, when it was last looked for
    float crept = 0.0F;           // apart from what is around it, at most in any image
  };
  std::vector<KeyframeState> keyframes;  // ascending
  std::vector<LandmarkState> landmarks;  // ascending

  // Nothing has crept.
  static LookedAtMap Of(const Atlas& atlas, MapId map);
};

// Of every map that was looked at. What is not in it counts as new: losing it costs one look at everything. As it holds
// what there was and is compared with what there is, merges and culling need to tell it nothing.
using LookMemory = std::map<MapId, LookedAtMap>;

}  // namespace pangaea
