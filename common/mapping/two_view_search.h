#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/map/keyframe.h"
#include "common/mapping/landmark_creation_options.h"
#include "common/mapping/measurement_noise.h"

namespace pangaea {

// A keypoint of one keyframe and one of another that seem to show the same point.
struct TwoViewMatch {
  std::uint32_t keypoint = 0;
  std::uint32_t other_keypoint = 0;
};

// Matches keypoints that have no landmark in either keyframe along epipolar lines, by descriptor, each the other's
// best. Of `keyframe` only those flagged `free` take part (as long as its keypoints). Ascending by keypoint. Nothing
// when the cameras are in one place.
std::vector<TwoViewMatch> MatchAlongEpipolarLines(const Keyframe& keyframe, const Keyframe& other,
                                                  const std::vector<bool>& free, const LandmarkCreationOptions& options,
                                                  const MeasurementNoiseOptions& noise);

// point_in_map from both views, stereo columns included. Nothing when parallax is too small, a view disagrees, or the
// octaves do not fit the distances.
std::optional<Eigen::Vector3d> TriangulateMatch(const Keyframe& keyframe, const Keyframe& other,
                                                const TwoViewMatch& match, const LandmarkCreationOptions& options,
                                                const MeasurementNoiseOptions& noise);

}  // namespace pangaea
