#include "agent/uplink/pose_distance.h"

#include <algorithm>

namespace pangaea {

PoseDistance DistanceOf(const Rigid3d& camera_from_map, const Rigid3d& other_camera_from_map) {
  const Rigid3d camera_from_other = camera_from_map * other_camera_from_map.Inverse();
  return {camera_from_other.translation().norm(), LogSo3(camera_from_other.rotation()).norm()};
}

bool HoldsFrame(const Keyframe& keyframe, const FramePose& frame, double tolerance_m, double tolerance_rad) {
  if (keyframe.frames == nullptr) return false;
  const auto present =
      std::lower_bound(keyframe.frames->begin(), keyframe.frames->end(), frame.stamp_ns,
                       [](const FramePose& held, std::int64_t stamp_ns) { return held.stamp_ns < stamp_ns; });
  if (present == keyframe.frames->end() || present->stamp_ns != frame.stamp_ns) return false;
  const PoseDistance distance = DistanceOf(present->reference_from_frame, frame.reference_from_frame);
  return distance.center_m <= tolerance_m && distance.angle_rad <= tolerance_rad;
}

}  // namespace pangaea
