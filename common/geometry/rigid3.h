#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

namespace pangaea {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// A rigid motion in SE(3), named target_from_source: point_in_target = target_from_source * point_in_source.
class Rigid3d {
 public:
  EIGEN_MAKE_ALIGNED_OPERATOR_NEW

  Rigid3d() = default;
  // `rotation` is normalised here. The quaternion is kept with w >= 0, so that equal motions have equal numbers.
  Rigid3d(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation);

  // The motion of exactly these numbers, to read back one that was written. Nothing unless the rotation is a unit
  // quaternion (within 1e-6) with w >= 0.
  static std::optional<Rigid3d> FromNormalized(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation);
  // The exponential map of a twist (translation part first, radians last).
  static Rigid3d Exp(const Vector6d& twist);
  Vector6d Log() const;

  const Eigen::Quaterniond& rotation() const { return rotation_; }
  const Eigen::Vector3d& translation() const { return translation_; }
  Eigen::Matrix4d Matrix() const;

  Rigid3d Inverse() const;
  Rigid3d operator*(const Rigid3d& other) const;
  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return rotation_ * point + translation_; }
  bool AllFinite() const { return rotation_.coeffs().allFinite() && translation_.allFinite(); }

 private:
  Eigen::Quaterniond rotation_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation_ = Eigen::Vector3d::Zero();
};

// The matrix of the cross product: Skew(a) * b == a.cross(b).
Eigen::Matrix3d Skew(const Eigen::Vector3d& vector);
// The exponential map of SO(3): a rotation vector (radians) as a unit quaternion.
Eigen::Quaterniond ExpSo3(const Eigen::Vector3d& rotation_vector);
// The rotation vector of a unit quaternion, angle in [0, pi].
Eigen::Vector3d LogSo3(const Eigen::Quaterniond& rotation);

}  // namespace pangaea
