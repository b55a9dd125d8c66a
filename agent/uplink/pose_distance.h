#pragma once

#include "common/geometry/rigid3.h"
#include "common/map/keyframe.h"

namespace pangaea {

struct PoseDistance {
  double center_m = 0.0;   // between the origins of the two cameras
  double angle_rad = 0.0;  // between their orientations
};

PoseDistance DistanceOf(const Rigid3d& camera_from_map, const Rigid3d& other_camera_from_map);

// Whether the keyframe holds the frame, with a pose that differs by no more than this.
bool HoldsFrame(const Keyframe& keyframe, const FramePose& frame, double tolerance_m, double tolerance_rad);

}  // namespace pangaea
