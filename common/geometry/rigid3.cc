#include "common/geometry/rigid3.h"

#include <cmath>

namespace pangaea {
namespace {

// Below this angle (radians) the closed forms lose digits and the series' first terms are exact to double precision.
constexpr double kSmallAngle = 1e-5;
// How far the norm of a quaternion that was normalised once may be from one.
constexpr double kUnitTolerance = 1e-6;

// The left Jacobian of SO(3), which takes the translation part of a twist to the translation of its exponential.
Eigen::Matrix3d LeftJacobian(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  const Eigen::Matrix3d skew = Skew(rotation_vector);
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() + 0.5 * skew + skew * skew / 6.0;
  const double squared = angle * angle;
  return Eigen::Matrix3d::Identity() + (1.0 - std::cos(angle)) / squared * skew +
         (angle - std::sin(angle)) / (squared * angle) * skew * skew;
}

}  // namespace

Eigen::Matrix3d Skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return matrix;
}

Eigen::Quaterniond ExpSo3(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  const double scale = angle < kSmallAngle ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  const Eigen::Vector3d vector = scale * rotation_vector;
  return Eigen::Quaterniond(std::cos(0.5 * angle), vector.x(), vector.y(), vector.z());
}

Eigen::Vector3d LogSo3(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d vector = sign * rotation.vec();
  const double sine = vector.norm();
  const double cosine = sign * rotation.w();
  if (sine < kSmallAngle) return 2.0 * vector / cosine;
  return 2.0 * std::atan2(sine, cosine) / sine * vector;
}

Rigid3d::Rigid3d(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation)
    : rotation_(rotation.normalized()), translation_(translation) {
  if (rotation_.w() < 0.0) rotation_.coeffs() = -rotation_.coeffs();
}

std::optional<Rigid3d> Rigid3d::FromNormalized(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation) {
  const bool unit = std::abs(rotation.squaredNorm() - 1.0) <= 2.0 * kUnitTolerance;  // false for NaN
  if (!unit || !(rotation.w() >= 0.0)) return std::nullopt;
  Rigid3d rigid;
  rigid.rotation_ = rotation;
  rigid.translation_ = translation;
  return rigid;
}

Rigid3d Rigid3d::Exp(const Vector6d& twist) {
  const Eigen::Vector3d rotation_vector = twist.tail<3>();
  return Rigid3d(ExpSo3(rotation_vector), LeftJacobian(rotation_vector) * twist.head<3>());
}

Vector6d Rigid3d::Log() const {
  Vector6d twist;
  twist.tail<3>() = LogSo3(rotation_);
  twist.head<3>() = LeftJacobian(twist.tail<3>()).inverse() * translation_;
  return twist;
}

Eigen::Matrix4d Rigid3d::Matrix() const {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = rotation_.toRotationMatrix();
  matrix.topRightCorner<3, 1>() = translation_;
  return matrix;
}

Rigid3d Rigid3d::Inverse() const {
  const Eigen::Quaterniond inverse = rotation_.conjugate();
  return Rigid3d(inverse, -(inverse * translation_));
}

Rigid3d Rigid3d::operator*(const Rigid3d& other) const {
  return Rigid3d(rotation_ * other.rotation_, rotation_ * other.translation_ + translation_);
}

}  // namespace pangaea
