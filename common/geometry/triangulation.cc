#include "common/geometry/triangulation.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "common/geometry/reprojection.h"

namespace pangaea {
namespace {

// A point whose information matrix is worse conditioned than this has no depth.
constexpr double kMinReciprocalCondition = 1e-12;

struct NormalEquations {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double cost = 0.0;
  double worst_chi2 = 0.0;
  bool in_front = true;
};

NormalEquations Linearize(std::span<const PointView> views, const Eigen::Vector3d& point_in_map) {
  NormalEquations equations;
  for (const PointView& view : views) {
    const Eigen::Vector3d point_in_camera = view.camera_from_map * point_in_map;
    equations.in_front = equations.in_front && point_in_camera.z() > kMinDepth;
    const Eigen::Vector3d error =
        view.inverse_sigma * ReprojectionError(view.camera, point_in_camera, view.measurement);
    const Eigen::Matrix3d jacobian = view.inverse_sigma *
                                     ReprojectionJacobian(view.camera, point_in_camera, IsStereo(view.measurement)) *
                                     view.camera_from_map.rotation().toRotationMatrix();
    equations.information += jacobian.transpose() * jacobian;
    equations.gradient += jacobian.transpose() * error;
    equations.cost += error.squaredNorm();
    equations.worst_chi2 = std::max(equations.worst_chi2, error.squaredNorm());
  }
  return equations;
}

bool IsDetermined(const NormalEquations& equations) {
  if (!equations.information.allFinite() || !std::isfinite(equations.cost)) return false;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(equations.information, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues()(0) > kMinReciprocalCondition * eigen.eigenvalues()(2);
}

}  // namespace

Ray PixelRay(const IdealCamera& camera, const Rigid3d& camera_from_map, const Eigen::Vector2d& pixel) {
  const Eigen::Quaterniond map_from_camera = camera_from_map.rotation().conjugate();
  return {-(map_from_camera * camera_from_map.translation()), map_from_camera * camera.Unproject(pixel).normalized()};
}

double ParallaxAngle(const Eigen::Vector3d& direction_a, const Eigen::Vector3d& direction_b) {
  return std::atan2(direction_a.cross(direction_b).norm(), direction_a.dot(direction_b));
}

std::optional<Eigen::Vector3d> TriangulateMidpoint(const Ray& a, const Ray& b, double min_parallax) {
  const Eigen::Vector3d direction_a = a.direction.normalized();
  const Eigen::Vector3d direction_b = b.direction.normalized();
  const Eigen::Vector3d normal = direction_a.cross(direction_b);
  const double sine_squared = normal.squaredNorm();
  const double angle = ParallaxAngle(direction_a, direction_b);
  if (!(angle >= min_parallax) || !(sine_squared > 0.0)) return std::nullopt;
  const Eigen::Vector3d baseline = b.origin - a.origin;
  const double along_a = baseline.cross(direction_b).dot(normal) / sine_squared;
  const double along_b = baseline.cross(direction_a).dot(normal) / sine_squared;
  if (!(along_a > 0.0) || !(along_b > 0.0)) return std::nullopt;
  const Eigen::Vector3d middle = 0.5 * (a.origin + along_a * direction_a + b.origin + along_b * direction_b);
  if (!middle.allFinite()) return std::nullopt;
  return middle;
}

std::optional<RefinedPoint> RefinePoint(std::span<const PointView> views, const Eigen::Vector3d& initial,
                                        const PointRefinementOptions& options) {
  Eigen::Vector3d point_in_map = initial;
  NormalEquations equations = Linearize(views, point_in_map);
  for (int i = 0; i < options.max_iterations; ++i) {
    if (!IsDetermined(equations)) return std::nullopt;
    const Eigen::Vector3d step = -equations.information.ldlt().solve(equations.gradient);
    NormalEquations next = Linearize(views, point_in_map + step);
    if (!(next.cost <= equations.cost)) {
      // Gauss-Newton overshoots where the parallax is small: half a step is then always shorter of the valley's bend.
      next = Linearize(views, point_in_map + 0.5 * step);
      if (!(next.cost <= equations.cost)) break;
      point_in_map += 0.5 * step;
    } else {
      point_in_map += step;
    }
    equations = next;
    const double distance = views.empty() ? 0.0 : (views.front().camera_from_map * point_in_map).norm();
    if (step.norm() <= options.step_tolerance * distance) break;
  }
  if (!equations.in_front || !IsDetermined(equations) || !point_in_map.allFinite()) return std::nullopt;
  return RefinedPoint{point_in_map, equations.information, equations.worst_chi2};
}

}  // namespace pangaea
