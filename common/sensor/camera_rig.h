#pragma once

#include <optional>

#include "common/geometry/rigid3.h"
#include "common/sensor/lens.h"

namespace pangaea {

// One or two cameras on a body, as calibrated. The body frame is the dataset's own (EuRoC: the IMU; KITTI: the left
// camera); its poses are what trajectories and ground truth hold.
struct CameraRig {
  LensModel left;
  Rigid3d body_from_left;
  std::optional<LensModel> right;
  Rigid3d body_from_right;  // meaningless without `right`
  // The images are undistorted and row-aligned as they come (KITTI): left and right are equal, without distortion,
  // the right one displaced along +x alone.
  bool already_rectified = false;

  bool is_stereo() const { return right.has_value(); }
};

}  // namespace pangaea
