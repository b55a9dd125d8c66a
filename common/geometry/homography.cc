#include "common/geometry/homography.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <numbers>

#include "common/geometry/direct_linear.h"

namespace pangaea {
namespace {

constexpr std::size_t kMinimalPoints = 4;
// Singular values closer to each other than this leave the plane's normal undetermined.
constexpr double kMinSingularRatio = 1.00001;

// What Faugeras and Lustman call R' and t', for one choice of signs: the motion in the axes of the singular vectors.
struct CanonicalMotion {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
};

// The case d' = +d2: both cameras on one side of the plane.
CanonicalMotion SameSide(const Eigen::Vector3d& d, double x1, double x3, double sine) {
  const double cosine = (d(1) * d(1) + d(0) * d(2)) / ((d(0) + d(2)) * d(1));
  CanonicalMotion motion;
  motion.rotation << cosine, 0.0, -sine, 0.0, 1.0, 0.0, sine, 0.0, cosine;
  motion.translation = (d(0) - d(2)) * Eigen::Vector3d(x1, 0.0, -x3);
  return motion;
}

// The case d' = -d2: the plane passes between the cameras.
CanonicalMotion OppositeSides(const Eigen::Vector3d& d, double x1, double x3, double sine) {
  const double cosine = (d(0) * d(2) - d(1) * d(1)) / ((d(0) - d(2)) * d(1));
  CanonicalMotion motion;
  motion.rotation << cosine, 0.0, sine, 0.0, -1.0, 0.0, sine, 0.0, -cosine;
  motion.translation = (d(0) + d(2)) * Eigen::Vector3d(x1, 0.0, x3);
  return motion;
}

}  // namespace

std::optional<Eigen::Matrix3d> ConditioningTransform(std::span<const Eigen::Vector2d> points) {
  if (points.empty()) return std::nullopt;
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point : points) centroid += point;
  centroid /= static_cast<double>(points.size());
  double distance = 0.0;
  for (const Eigen::Vector2d& point : points) distance += (point - centroid).norm();
  distance /= static_cast<double>(points.size());
  if (!(distance > 0.0) || !std::isfinite(distance)) return std::nullopt;
  const double scale = std::numbers::sqrt2 / distance;
  Eigen::Matrix3d transform;
  transform << scale, 0.0, -scale * centroid.x(), 0.0, scale, -scale * centroid.y(), 0.0, 0.0, 1.0;
  return transform;
}

std::optional<Eigen::Matrix3d> FitHomography(std::span<const Eigen::Vector2d> first,
                                             std::span<const Eigen::Vector2d> second) {
  using direct_linear::Vector9d;
  const auto add = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b, direct_linear::Matrix9d& normal) {
    Vector9d row_u, row_v;
    row_u << a, Eigen::Vector3d::Zero(), -b.x() * a;
    row_v << Eigen::Vector3d::Zero(), a, -b.y() * a;
    normal += row_u * row_u.transpose() + row_v * row_v.transpose();
  };
  // Two solutions of equal error: collinear points.
  const auto solution = direct_linear::Solve(first, second, kMinimalPoints, 1e-9, add);
  if (!solution) return std::nullopt;
  const Eigen::Matrix3d homography =
      solution->condition_second.inverse() * solution->conditioned * solution->condition_first;
  if (!homography.allFinite()) return std::nullopt;
  return homography;
}

std::vector<Rigid3d> DecomposeHomography(const Eigen::Matrix3d& second_from_first) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(second_from_first, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d d = svd.singularValues();
  if (!(d(2) > 0.0) || d(0) < kMinSingularRatio * d(1) || d(1) < kMinSingularRatio * d(2)) return {};
  const double sign = svd.matrixU().determinant() * svd.matrixV().determinant();
  const double span = d(0) * d(0) - d(2) * d(2);
  const double near = d(0) * d(0) - d(1) * d(1);
  const double far = d(1) * d(1) - d(2) * d(2);
  const double same_side_sine = std::sqrt(near * far) / ((d(0) + d(2)) * d(1));
  const double opposite_sine = std::sqrt(near * far) / ((d(0) - d(2)) * d(1));
  std::vector<Rigid3d> motions;
  for (const double sign_1 : {1.0, -1.0}) {
    for (const double sign_3 : {1.0, -1.0}) {
      const double x1 = sign_1 * std::sqrt(near / span);
      const double x3 = sign_3 * std::sqrt(far / span);
      for (const CanonicalMotion& motion : {SameSide(d, x1, x3, sign_1 * sign_3 * same_side_sine),
                                            OppositeSides(d, x1, x3, sign_1 * sign_3 * opposite_sine)}) {
        const Eigen::Matrix3d rotation = sign * svd.matrixU() * motion.rotation * svd.matrixV().transpose();
        motions.emplace_back(Eigen::Quaterniond(rotation), (svd.matrixU() * motion.translation).normalized());
      }
    }
  }
  return motions;
}

}  // namespace pangaea
