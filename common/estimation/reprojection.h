#pragma once

#include <Eigen/Core>

#include "common/geometry/ideal_camera.h"
#include "common/geometry/rigid3.h"

namespace pangaea {

// 95 % quantiles of the chi-squared distribution for two (u, v) and three (u, v, u_right) measurements.
inline constexpr double kMonocularChi2 = 5.991;
inline constexpr double kStereoChi2 = 7.815;

// A depth, in map units, below which a point counts as behind the camera. Projections divide by no less than this, so
// that costs stay finite and continuous when an optimiser's step takes a point through the image plane.
inline constexpr double kMinDepth = 0.01;

// u_right < 0 marks a monocular measurement.
inline bool IsStereo(const Eigen::Vector3d& measurement) { return measurement.z() >= 0.0; }

// predicted - measured, pixels: (u, v, u_right); the last is 0 for a monocular measurement.
Eigen::Vector3d ReprojectionError(const IdealCamera& camera, const Eigen::Vector3d& point_in_camera,
                                  const Eigen::Vector3d& measurement);

// The derivative of ReprojectionError by the point in the camera frame; the last row is 0 for a monocular measurement.
Eigen::Matrix3d ReprojectionJacobian(const IdealCamera& camera, const Eigen::Vector3d& point_in_camera, bool stereo);

// The derivative of a point in the camera frame by the perturbation camera_from_map <- Exp(e) * camera_from_map,
// e = (translation, rotation), at e = 0.
Eigen::Matrix<double, 3, 6> PerturbationJacobian(const Eigen::Vector3d& point_in_camera);

}  // namespace pangaea
