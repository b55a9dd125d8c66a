#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "common/geometry/reprojection.h"

// The innermost part of local_bundle.cc: one camera's view of one point, linearised, in as few operations as there are.

namespace pangaea::local_bundle {

// A pose and its camera, ready to project.
struct Camera {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  double focal_x, focal_y, center_x, center_y, baseline;
  int variable;  // index among the free poses, -1: fixed
};

struct Measurement {
  double u, v, disparity;
  double squared_weight;  // inverse_sigma^2
  double bend;            // of Huber's kernel, a squared residual in sigmas
  int camera;
  bool stereo;
};

// One camera's view of a point. With A = J' w J, J the projection's derivative by the point in the camera:
struct View {
  Eigen::Vector3d point_in_camera;
  double xx, xz, yy, yz, zz;  // A; its (x, y) entry is 0
  Eigen::Vector3d gradient;   // J' w error
  double cost;                // kernel of the squared residual
};

inline double Huber(double squared, double bend, double& weight) {
  if (squared <= bend) {
    weight = 1.0;
    return squared;
  }
  weight = std::sqrt(bend / squared);
  return 2.0 * weight * squared - bend;
}

struct Residual {
  double x, y, z, inverse_depth;
  double u, v, d;  // as ReprojectionError
  double squared;
};

inline Residual Project(const Camera& camera, const Measurement& measurement, const Eigen::Vector3d& point_in_map) {
  const Eigen::Vector3d p = camera.rotation * point_in_map + camera.translation;
  Residual e;
  e.x = p.x();
  e.y = p.y();
  e.z = p.z();
  e.inverse_depth = 1.0 / std::max(e.z, kMinDepth);
  const double a = camera.focal_x * e.inverse_depth;
  e.u = a * e.x + camera.center_x - measurement.u;
  e.v = camera.focal_y * e.inverse_depth * e.y + camera.center_y - measurement.v;
  e.d = measurement.stereo ? kDisparityPrecision * (a * camera.baseline - measurement.disparity) : 0.0;
  e.squared = measurement.squared_weight * (e.u * e.u + e.v * e.v + e.d * e.d);
  return e;
}

inline View LookAt(const Camera& camera, const Measurement& measurement, const Eigen::Vector3d& point_in_map) {
  const Residual e = Project(camera, measurement, point_in_map);
  View view;
  double weight = 1.0;
  view.cost = Huber(e.squared, measurement.bend, weight);
  const double w = weight * measurement.squared_weight;
  const double slope = e.z > kMinDepth ? e.inverse_depth : 0.0;
  const double a = camera.focal_x * e.inverse_depth;
  const double b = camera.focal_y * e.inverse_depth;
  const double du = -a * e.x * slope;
  const double dv = -b * e.y * slope;
  const double dd = measurement.stereo ? -kDisparityPrecision * a * camera.baseline * slope : 0.0;
  view.point_in_camera = {e.x, e.y, e.z};
  view.xx = w * a * a;
  view.xz = w * a * du;
  view.yy = w * b * b;
  view.yz = w * b * dv;
  view.zz = w * (du * du + dv * dv + dd * dd);
  view.gradient = {w * a * e.u, w * b * e.v, w * (du * e.u + dv * e.v + dd * e.d)};
  return view;
}

// Adds G' A G, G = (I, -[p]x): the information of a pose perturbed on the left. Upper triangle only.
inline void AddPoseBlock(const View& view, Matrix6d& block, Vector6d& gradient) {
  const double x = view.point_in_camera.x(), y = view.point_in_camera.y(), z = view.point_in_camera.z();
  const double c00 = y * view.xz, c01 = z * view.xx - x * view.xz, c02 = -y * view.xx;
  const double c10 = y * view.yz - z * view.yy, c11 = -x * view.yz, c12 = x * view.yy;
  const double c20 = y * view.zz - z * view.yz, c21 = z * view.xz - x * view.zz, c22 = x * view.yz - y * view.xz;
  block(0, 0) += view.xx;
  block(0, 2) += view.xz;
  block(1, 1) += view.yy;
  block(1, 2) += view.yz;
  block(2, 2) += view.zz;
  block(0, 3) += c00;
  block(1, 3) += c10;
  block(2, 3) += c20;
  block(0, 4) += c01;
  block(1, 4) += c11;
  block(2, 4) += c21;
  block(0, 5) += c02;
  block(1, 5) += c12;
  block(2, 5) += c22;
  block(3, 3) += y * c20 - z * c10;
  block(3, 4) += y * c21 - z * c11;
  block(4, 4) += z * c01 - x * c21;
  block(3, 5) += y * c22 - z * c12;
  block(4, 5) += z * c02 - x * c22;
  block(5, 5) += x * c12 - y * c02;
  gradient.head<3>() += view.gradient;
  gradient.tail<3>() += view.point_in_camera.cross(view.gradient);
}

}  // namespace pangaea::local_bundle
