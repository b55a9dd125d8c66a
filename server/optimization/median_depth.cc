#include "server/optimization/median_depth.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "common/base/median.h"
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
  const double median = Median(std::move(depths), 1.0);
  // A landmark behind its reference is a fault of somebody else's, no length.
  return median > 0.0 ? median : 1.0;
}

}  // namespace pangaea
