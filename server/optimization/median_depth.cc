#include "server/optimization/median_depth.h"

#include <algorithm>
#include <vector>

#include "common/map/spanning_tree.h"

namespace pangaea {

double MedianDepth(const Atlas& atlas, MapId map) {
  std::vector<double> depths;
  for (const KeyframeId id : ParentsFirst(atlas, map)) {
    const Keyframe& keyframe = *atlas.FindKeyframe(id);
    for (const LandmarkId seen : keyframe.landmarks) {
      const Landmark* landmark = atlas.FindLandmark(seen);
      if (landmark == nullptr || landmark->reference != id) continue;
      depths.push_back((keyframe.camera_from_map * landmark->point_in_map).z());
    }
  }
  if (depths.empty()) return 1.0;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  // A landmark behind its reference is a fault of somebody else's, no length.
  return *middle > 0.0 ? *middle : 1.0;
}

}  // namespace pangaea
