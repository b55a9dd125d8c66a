#include "common/sensor/lens.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace pangaea {
namespace {

constexpr int kMaxIterations = 50;
// Newton's method ends when a step (normalised units) is this small: far below a pixel for any focal length.
constexpr double kConverged = 1e-12;
constexpr double kDerivativeStep = 1e-6;
// The farthest that FoldingRadius looks, and its step: tan(89 degrees) is 57.
constexpr double kFarthestRadius = 60.0;
constexpr double kRadiusStep = 0.005;
constexpr double kRightAngle = 1.5707963267948966;

// Brown, "Decentering distortion of lenses", 1966.
Eigen::Vector2d DistortRadialTangential(const std::array<double, 5>& k, const Eigen::Vector2d& p) {
  const auto [k1, k2, p1, p2, k3] = k;
  const double x = p.x();
  const double y = p.y();
  const double squared = p.squaredNorm();
  const double radial = 1.0 + squared * (k1 + squared * (k2 + squared * k3));
  return {x * radial + 2.0 * p1 * x * y + p2 * (squared + 2.0 * x * x),
          y * radial + p1 * (squared + 2.0 * y * y) + 2.0 * p2 * x * y};
}

// Angle off the axis to distance in the image; Kannala and Brandt, "A generic camera model...", 2006, Eq. (6).
double EquidistantRadius(const std::array<double, 5>& k, double angle) {
  const double squared = angle * angle;
  return angle * (1.0 + squared * (k[0] + squared * (k[1] + squared * (k[2] + squared * k[3]))));
}

double EquidistantSlope(const std::array<double, 5>& k, double angle) {
  const double squared = angle * angle;
  return 1.0 + squared * (3.0 * k[0] + squared * (5.0 * k[1] + squared * (7.0 * k[2] + squared * 9.0 * k[3])));
}

double RadialSlope(const std::array<double, 5>& k, double radius) {
  const double squared = radius * radius;
  return 1.0 + squared * (3.0 * k[0] + squared * (5.0 * k[1] + squared * 7.0 * k[4]));
}

std::optional<Eigen::Vector2d> UndistortEquidistant(const std::array<double, 5>& k, const Eigen::Vector2d& distorted) {
  const double target = distorted.norm();
  if (target < kConverged) return distorted;
  double angle = std::min(target, kRightAngle);
  for (int i = 0; i < kMaxIterations; ++i) {
    const double slope = EquidistantSlope(k, angle);
    if (slope <= 0.0) return std::nullopt;
    const double step = (target - EquidistantRadius(k, angle)) / slope;
    angle += step;
    if (std::abs(step) < kConverged) break;
  }
  const bool solved = std::abs(EquidistantRadius(k, angle) - target) < 1e3 * kConverged;
  if (!solved || angle <= 0.0 || angle >= kRightAngle) return std::nullopt;
  return Eigen::Vector2d(distorted * (std::tan(angle) / target));
}

// Newton's method on both coordinates, with a numeric Jacobian (the coefficients are few, the exact one is long) and
// steps halved until they improve.
std::optional<Eigen::Vector2d> UndistortRadialTangential(const std::array<double, 5>& k,
                                                         const Eigen::Vector2d& distorted) {
  Eigen::Vector2d point = distorted;
  Eigen::Vector2d residual = distorted - DistortRadialTangential(k, point);
  for (int i = 0; i < kMaxIterations && residual.norm() > kConverged; ++i) {
    Eigen::Matrix2d jacobian;
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d step = kDerivativeStep * Eigen::Vector2d::Unit(axis);
      jacobian.col(axis) =
          (DistortRadialTangential(k, point + step) - DistortRadialTangential(k, point - step)) / (2 * kDerivativeStep);
    }
    if (jacobian.determinant() <= 0.0) return std::nullopt;
    Eigen::Vector2d step = jacobian.inverse() * residual;
    Eigen::Vector2d next = distorted - DistortRadialTangential(k, point + step);
    while (next.norm() > residual.norm() && step.norm() > kConverged) {
      step *= 0.5;
      next = distorted - DistortRadialTangential(k, point + step);
    }
    point += step;
    residual = next;
  }
  if (!(residual.norm() < 1e3 * kConverged)) return std::nullopt;
  return point;
}

}  // namespace

bool LensModel::is_distorted() const {
  // The equidistant projection differs from a pinhole even where all its coefficients are zero.
  return kind == LensKind::kEquidistant || std::ranges::any_of(coefficients, [](double k) { return k != 0.0; });
}

Eigen::Vector2d LensModel::Distort(const Eigen::Vector2d& normalised) const {
  if (!is_distorted()) return normalised;
  if (kind == LensKind::kRadialTangential) return DistortRadialTangential(coefficients, normalised);
  const double radius = normalised.norm();
  if (radius < kConverged) return normalised;
  return normalised * (EquidistantRadius(coefficients, std::atan(radius)) / radius);
}

std::optional<Eigen::Vector2d> LensModel::Undistort(const Eigen::Vector2d& distorted) const {
  if (!is_distorted()) return distorted;
  return kind == LensKind::kRadialTangential ? UndistortRadialTangential(coefficients, distorted)
                                             : UndistortEquidistant(coefficients, distorted);
}

Eigen::Vector2d LensModel::Project(const Eigen::Vector3d& point_in_camera) const {
  const Eigen::Vector2d distorted = Distort(point_in_camera.head<2>() / point_in_camera.z());
  return {focal_x * distorted.x() + center_x, focal_y * distorted.y() + center_y};
}

std::optional<Eigen::Vector2d> LensModel::Unproject(const Eigen::Vector2d& pixel) const {
  return Undistort({(pixel.x() - center_x) / focal_x, (pixel.y() - center_y) / focal_y});
}

double LensModel::FoldingRadius() const {
  for (double radius = 0.0; is_distorted() && radius < kFarthestRadius; radius += kRadiusStep) {
    const double slope = kind == LensKind::kRadialTangential ? RadialSlope(coefficients, radius)
                                                             : EquidistantSlope(coefficients, std::atan(radius));
    if (slope <= 0.0) return radius;
  }
  return std::numeric_limits<double>::infinity();
}

Status LensModel::Check(std::string_view place) const {
  const auto refuse = [&](const std::string& what) {
    return Fail(ErrorCode::kInvalidArgument, std::string(place) + ": " + what);
  };
  if (width < 16 || height < 16 || width > 16384 || height > 16384) {
    return refuse("the image size is " + std::to_string(width) + " x " + std::to_string(height) +
                  "; allowed: 16 to 16384 pixels each");
  }
  if (!std::isfinite(focal_x) || !std::isfinite(focal_y) || focal_x <= 0.0 || focal_y <= 0.0) {
    return refuse("the focal lengths are not positive and finite");
  }
  const bool finite = std::isfinite(center_x) && std::isfinite(center_y) &&
                      std::ranges::all_of(coefficients, [](double k) { return std::isfinite(k); });
  if (!finite) return refuse("the principal point or a distortion coefficient is not finite");
  return {};
}

}  // namespace pangaea
