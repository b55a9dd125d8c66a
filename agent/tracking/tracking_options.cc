#include "agent/tracking/tracking_options.h"

#include <string>

namespace pangaea {
namespace {

template <typename T>
Status InRange(const char* name, T value, T low, T high) {
  if (value >= low && value <= high) return {};
  return Fail(ErrorCode::kInvalidArgument, std::string("tracking.") + name + " is " + std::to_string(value) +
                                               ", allowed is " + std::to_string(low) + " to " + std::to_string(high));
}

}  // namespace

TrackingOptions TrackingOptions::ForCamera(const IdealCamera& camera) const {
  TrackingOptions options = *this;
  if (camera.is_stereo()) return options;
  options.keyframes = monocular_keyframes;
  options.orb.features = monocular_features;
  return options;
}

Status TrackingOptions::Check() const {
  for (const Status& status : {
           InRange("min_inliers", min_inliers, 6, 1000),
           InRange("min_agreement", min_agreement, 0.0, 1.0),
           InRange("min_recovery_inliers", min_recovery_inliers, 6, 1000),
           InRange("min_start_points", min_start_points, 20, 5000),
           InRange("frames_until_new_map", frames_until_new_map, 1, 100000),
           InRange("frames_for_hint", frames_for_hint, 0, 100000),
           InRange("pyramid_levels", pyramid_levels, 3, kMaxPyramidLevels),
           InRange("search.max_landmarks", search.max_landmarks, 20, 5000),
           InRange("search.patch_sigma", search.patch_sigma, 0.05, 10.0),
           InRange("keyframes.min_coverage_ratio", keyframes.min_coverage_ratio, 0.1, 1.0),
           InRange("keyframes.min_inlier_ratio", keyframes.min_inlier_ratio, 0.1, 1.0),
           InRange("keyframes.max_relative_distance", keyframes.max_relative_distance, 0.01, 10.0),
           InRange("keyframes.max_turn", keyframes.max_turn, 1.0, 180.0),
           InRange("keyframes.others_view", keyframes.others_view, 1.0, 1000.0),
           InRange("start_depth_baselines", start_depth_baselines, 1.0, 10000.0),
           observability.Check(),
           monocular_start.Check(),
           orb.Check(),
           stereo.Check(),
       }) {
    if (!status) return status;
  }
  return {};
}

}  // namespace pangaea
