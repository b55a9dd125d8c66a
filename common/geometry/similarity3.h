#pragma once

#include <optional>

#include "common/geometry/rigid3.h"

namespace pangaea {

// A similarity in Sim(3): point_in_target = scale * rotation * point_in_source + translation. scale > 0.
class Similarity3d {
 public:
  EIGEN_MAKE_ALIGNED_OPERATOR_NEW

  Similarity3d() = default;
  Similarity3d(double scale, const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation);
  explicit Similarity3d(const Rigid3d& rigid) : Similarity3d(1.0, rigid.rotation(), rigid.translation()) {}
  // The similarity of exactly these numbers; nothing unless the rotation is one for Rigid3d::FromNormalized and the
  // scale is positive and finite.
  static std::optional<Similarity3d> FromNormalized(double scale, const Eigen::Quaterniond& rotation,
                                                    const Eigen::Vector3d& translation);

  double scale() const { return scale_; }
  const Eigen::Quaterniond& rotation() const { return rotation_; }
  const Eigen::Vector3d& translation() const { return translation_; }

  Similarity3d Inverse() const;
  Similarity3d operator*(const Similarity3d& other) const;
  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return scale_ * (rotation_ * point) + translation_; }
  // How a camera moves with its map: camera_from_source, lengths in source units, becomes camera_from_target, lengths
  // in target units; *this is target_from_source.
  Rigid3d TransformCamera(const Rigid3d& camera_from_source) const;
  bool AllFinite() const;

 private:
  double scale_ = 1.0;
  Eigen::Quaterniond rotation_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation_ = Eigen::Vector3d::Zero();
};

}  // namespace pangaea
