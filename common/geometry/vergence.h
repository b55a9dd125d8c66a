#pragma once

#include "common/geometry/ideal_camera.h"

namespace pangaea {

// The vergence of a stereo rig, radians: by how much more than its calibration says the right camera is turned about
// the image's y axis, positive towards the left one. What lies in column u of the left image (pixels) is seen this many
// pixels too far right in the right image: f (1 + x²) times the angle, with x the tangent of the ray (the derivative of
// f tan by the angle). The columns of the two views of a point differ little beside f, so that one x serves for both.
inline double VergenceShift(const IdealCamera& camera, double u, double vergence) {
  const double x = (u - camera.center_x) / camera.focal_x;
  return camera.focal_x * (1.0 + x * x) * vergence;
}

}  // namespace pangaea
