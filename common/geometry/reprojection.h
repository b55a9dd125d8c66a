#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "common/geometry/ideal_camera.h"
#include "common/geometry/rigid3.h"

namespace pangaea {

// 95 % quantiles of the chi-squared distribution for two (u, v) and three (u, v, disparity) measurements.
inline constexpr double kMonocularChi2 = 5.991;
inline constexpr double kStereoChi2 = 7.815;

// A depth, in map units, below which a point counts as behind the camera. Projections divide by no less than this, so
// that costs stay finite and continuous when an optimiser's step takes a point through the image plane.
inline constexpr double kMinDepth = 0.01;

// How many times better a disparity is known than the keypoint's own column and row: the right column is found by
// comparing the images around the keypoint, wherever in them the keypoint lies, so that its error has nothing to do
// with the keypoint's (docs/decisions/0026-disparities.md).
inline constexpr double kDisparityPrecision = 3.0;

// u_right < 0 marks a monocular measurement.
inline bool IsStereo(const Eigen::Vector3d& measurement) { return measurement.z() >= 0.0; }

// predicted - measured: u, v in pixels, and the disparity u - u_right in pixels times kDisparityPrecision, so that all
// three have one standard deviation; the last is 0 for a monocular measurement.
inline Eigen::Vector3d ReprojectionError(const IdealCamera& camera, const Eigen::Vector3d& point_in_camera,
                                         const Eigen::Vector3d& measurement) {
  const double inverse_depth = 1.0 / std::max(point_in_camera.z(), kMinDepth);
  const double u = camera.focal_x * point_in_camera.x() * inverse_depth + camera.center_x;
  const double v = camera.focal_y * point_in_camera.y() * inverse_depth + camera.center_y;
  const double disparity = camera.focal_x * camera.baseline * inverse_depth;
  const double measured = measurement.x() - measurement.z();
  return {u - measurement.x(), v - measurement.y(),
          IsStereo(measurement) ? kDisparityPrecision * (disparity - measured) : 0.0};
}

// The derivative of ReprojectionError by the point in the camera frame; the last row is 0 for a monocular measurement.
inline Eigen::Matrix3d ReprojectionJacobian(const IdealCamera& camera, const Eigen::Vector3d& point_in_camera,
                                            bool stereo) {
  const double inverse_depth = 1.0 / std::max(point_in_camera.z(), kMinDepth);
  // Behind the least depth the projection no longer depends on depth.
  const double slope = point_in_camera.z() > kMinDepth ? -inverse_depth : 0.0;
  const double scale_x = camera.focal_x * inverse_depth;
  const double scale_y = camera.focal_y * inverse_depth;
  Eigen::Matrix3d jacobian;
  jacobian << scale_x, 0.0, slope * scale_x * point_in_camera.x(),  //
      0.0, scale_y, slope * scale_y * point_in_camera.y(),          //
      0.0, 0.0, kDisparityPrecision * slope * scale_x * camera.baseline;
  if (!stereo) jacobian.row(2).setZero();
  return jacobian;
}

// The derivative of a point in the camera frame by the perturbation camera_from_map <- Exp(e) * camera_from_map,
// e = (translation, rotation), at e = 0.
inline Eigen::Matrix<double, 3, 6> PerturbationJacobian(const Eigen::Vector3d& point_in_camera) {
  Eigen::Matrix<double, 3, 6> jacobian;
  jacobian.leftCols<3>().setIdentity();
  jacobian.rightCols<3>() = -Skew(point_in_camera);
  return jacobian;
}

}  // namespace pangaea
