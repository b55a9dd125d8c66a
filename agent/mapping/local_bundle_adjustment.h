#pragma once

#include <Eigen/Core>
#include <stop_token>
#include <utility>
#include <vector>

#include "agent/mapping/local_mapping_options.h"
#include "common/map/atlas.h"
#include "common/map/edits/edits.h"

namespace pangaea {

// What a local bundle adjustment moves, and who holds it in place.
struct AdjustmentWindow {
  std::vector<KeyframeId> free;       // the newest and those around it, never the root or a read-only one
  std::vector<KeyframeId> fixed;      // see the same landmarks; may be empty where `held` are enough to hold the gauge
  std::vector<LandmarkId> landmarks;  // ascending; seen by a free keyframe and at least one more
  std::vector<LandmarkId> held;       // ascending; read-only (IsReadOnly), seen by a free keyframe
  // Landmarks that one free keyframe alone sees: they say nothing about its pose and move with it.
  std::vector<LandmarkId> carried;
};

// Empty when nothing can move: the newest keyframe is the root.
AdjustmentWindow ChooseAdjustmentWindow(const Atlas& atlas, KeyframeId newest,
                                        const LocalBundleAdjustmentOptions& options);

// The outcome: absolute state, to be turned into edits by MoveKeyframesTo and MoveLandmarksTo.
struct LocalAdjustment {
  std::vector<std::pair<KeyframeId, Rigid3d>> camera_from_map;
  std::vector<std::pair<LandmarkId, Eigen::Vector3d>> point_in_map;
  // Observations that contradict the adjusted map; a landmark that would keep too few of them goes altogether.
  std::vector<MapEdit> removals;
  double outlier_share = 0.0;  // of the observations in the window
};

// Minimises the reprojection errors in the window. A stop ends it early with the best state so far.
LocalAdjustment AdjustLocalMap(const Atlas& atlas, const AdjustmentWindow& window,
                               const LocalBundleAdjustmentOptions& options, const MeasurementNoiseOptions& noise,
                               std::stop_token stop);

}  // namespace pangaea
