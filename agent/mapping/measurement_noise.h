#pragma once

#include <Eigen/Core>

#include "agent/mapping/local_mapping_options.h"
#include "common/geometry/keypoint.h"

namespace pangaea {

// What a keypoint measures, as estimation wants it: ideal pixel (u, v, u_right), u_right < 0 where unknown.
inline Eigen::Vector3d MeasurementOf(const Keypoint& keypoint) {
  return {keypoint.u, keypoint.v, keypoint.has_depth() ? keypoint.u_right : -1.0};
}

// How far, in pixels, a keypoint may be from the truth: one standard deviation. The one place that decides it.
inline double SigmaOf(const Keypoint& keypoint, const MeasurementNoiseOptions& options) {
  return options.pixel_sigma * OctaveSigma(keypoint.octave);
}

}  // namespace pangaea
