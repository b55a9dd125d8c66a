#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/map/ids.h"

namespace pangaea {

// Which keypoint of which keyframe shows a landmark.
struct Observation {
  KeyframeId keyframe;
  std::uint32_t keypoint = 0;
  bool operator==(const Observation&) const = default;
};

struct Landmark {
  LandmarkId id;
  Eigen::Vector3d point_in_map = Eigen::Vector3d::Zero();
  // The keyframe in whose camera frame the point travels; always one of the observers.
  KeyframeId reference;
  std::vector<Observation> observations;  // ascending by keyframe id, one per keyframe, never empty
};

}  // namespace pangaea
