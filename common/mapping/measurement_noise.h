#pragma once

#include <Eigen/Core>

#include "common/geometry/ideal_camera.h"
#include "common/geometry/keypoint.h"

namespace pangaea {

struct MeasurementNoiseOptions {
  double pixel_sigma = 1.0;  // standard deviation of u, v and u_right at octave 0, pixels
  // Depth beyond so many baselines is measured by motion alone. An error of the rig's calibration moves all disparities
  // alike, which for far points is a large part of the depth: it would stretch the map.
  double max_depth_baselines = 40.0;
};

// What a keypoint saw, as estimation wants it: ideal pixel (u, v, u_right), u_right < 0 where unknown.
inline Eigen::Vector3d MeasurementOf(const Keypoint& keypoint) {
  return {keypoint.u, keypoint.v, keypoint.has_depth() ? keypoint.u_right : -1.0};
}

// The part of it that poses and points may rest on: u_right < 0 also where the point is so far that its disparity says
// less about the scale than a small error of the calibration.
inline Eigen::Vector3d ReliableMeasurementOf(const IdealCamera& camera, const Keypoint& keypoint,
                                             const MeasurementNoiseOptions& options) {
  const double disparity = keypoint.u - keypoint.u_right;
  const bool reliable = keypoint.has_depth() && disparity * options.max_depth_baselines >= camera.focal_x;
  return {keypoint.u, keypoint.v, reliable ? keypoint.u_right : -1.0};
}

// How far, in pixels, a keypoint may be from the truth: one standard deviation. The one place that decides it.
inline double SigmaOf(const Keypoint& keypoint, const MeasurementNoiseOptions& options) {
  return options.pixel_sigma * OctaveSigma(keypoint.octave);
}

}  // namespace pangaea
