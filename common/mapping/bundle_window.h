#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "common/estimation/bundle_adjustment.h"
#include "common/map/atlas.h"
#include "common/map/edits/edits.h"
#include "common/mapping/measurement_noise.h"

namespace pangaea {

// Part of a map that a bundle adjustment moves, and who holds it in place. The lists have no id in common, all are
// alive and of one map.
struct BundleWindow {
  std::vector<KeyframeId> free;
  std::vector<KeyframeId> fixed;
  std::vector<LandmarkId> landmarks;
};

// The window in numbers, and what the numbers stand for.
struct WindowBundle {
  BundleProblem problem;              // poses: the free, then the fixed; points: the landmarks, index by index
  std::vector<KeyframeId> keyframes;  // of the poses
  std::vector<LandmarkId> landmarks;  // of the points
  std::unordered_map<KeyframeId, int> pose_index;
};

// The observations are those of the landmarks from the keyframes of the window, landmark by landmark, for each
// ascending by keyframe.
WindowBundle BuildWindowBundle(const Atlas& atlas, const BundleWindow& window, const MeasurementNoiseOptions& noise);

// Removes the observations that the solution found to be outliers (per observation of the problem). A landmark goes
// altogether when what remains does not determine it: two views, or one with depth.
std::vector<MapEdit> RemoveOutliers(const Atlas& atlas, const WindowBundle& bundle,
                                    std::span<const std::uint8_t> outliers);

}  // namespace pangaea
