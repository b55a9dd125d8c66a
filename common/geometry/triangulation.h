#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "common/geometry/ideal_camera.h"
#include "common/geometry/rigid3.h"

namespace pangaea {

// A half line in the map frame. `direction` need not have unit length.
struct Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;
};

// The ray through a pixel of a camera at camera_from_map, in the map frame, with unit direction.
Ray PixelRay(const IdealCamera& camera, const Rigid3d& camera_from_map, const Eigen::Vector2d& pixel);

// The angle between two directions, radians in [0, pi].
double ParallaxAngle(const Eigen::Vector3d& direction_a, const Eigen::Vector3d& direction_b);

// The middle of the shortest segment between two rays. Nothing when they are parallel to less than `min_parallax`
// (radians), or when the segment ends behind either origin.
std::optional<Eigen::Vector3d> TriangulateMidpoint(const Ray& a, const Ray& b, double min_parallax);

// One view of one point: the ideal pixel (u, v, u_right), u_right < 0 where there is no stereo measurement.
struct PointView {
  IdealCamera camera;
  Rigid3d camera_from_map;
  Eigen::Vector3d measurement;
  double inverse_sigma = 1.0;  // 1 / pixels
};

struct RefinedPoint {
  Eigen::Vector3d point_in_map;
  Eigen::Matrix3d information;  // of point_in_map, from the measurements' sigmas
  double worst_chi2 = 0.0;      // the largest squared residual of a view, in sigmas
};

struct PointRefinementOptions {
  int max_iterations = 8;
  double step_tolerance = 1e-6;  // stop when a step is shorter than this times the point's distance
};

// The point that minimises the squared reprojection errors in all views, by Gauss-Newton from `initial`. Nothing when
// the views do not determine it (no parallax), when it ends behind a camera, or when an input is not finite.
std::optional<RefinedPoint> RefinePoint(std::span<const PointView> views, const Eigen::Vector3d& initial,
                                        const PointRefinementOptions& options = {});

}  // namespace pangaea
