#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/rigid3.h"
#include "common/map/atlas.h"
#include "common/map/edits/edits.h"
#include "common/map/ids.h"

namespace pangaea {

struct CorrectedKeyframe {
  KeyframeId id;
  Rigid3d camera_from_map;
  // Lengths around this keyframe are multiplied by this: 1 but for a scale-free map whose scale drifted.
  double scale = 1.0;
};

struct CorrectedLandmark {
  LandmarkId id;
  Eigen::Vector3d point_in_map;
};

// What a long job (welding, pose graph, global bundle adjustment) found out about one map, against the snapshot it
// worked on. The owner of the atlas rebases it onto what it has become since.
struct Correction {
  Atlas base;  // the snapshot
  MapId map;
  std::vector<CorrectedKeyframe> keyframes;  // those that move; each once
  std::vector<CorrectedLandmark> landmarks;  // those that move on their own; others follow their reference keyframe
};

// The version that moves of a correction carry until the owner of the atlas writes the position of its edit there.
inline constexpr std::uint64_t kProvisionalCorrection = 1;

// The edits that bring a correction onto the atlas as it is now (design: "rebases"): ids that vanished are skipped; a
// keyframe whose pose relative to its parent was edited after the snapshot keeps its current pose relative to its
// parent (scaled where the correction scales there), any other takes the corrected pose; keyframes newer than the
// snapshot follow their spanning-tree parent, landmarks their reference keyframe. What the snapshot had and the
// correction does not name stays. Where the tree hangs together in another way by now, the nearest keyframe above that
// the snapshot has stands for the parent in that comparison.
// Empty where the map is gone, also into another one: what was welded to it since was welded to its old shape, and the
// correction would tear it off again. A map that took in others keeps its frame; what came in follows like anything
// new.
std::vector<MapEdit> Rebase(const Correction& correction, const Atlas& current);
// The same to an atlas that takes each edit before the next one is made: `apply` makes it a part of `atlas`. Ends with
// the first failure of `apply`, and returns it.
Status Rebase(const Correction& correction, const Atlas& atlas, const std::function<Status(MapEdit)>& apply);

}  // namespace pangaea
