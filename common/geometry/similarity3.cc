#include "common/geometry/similarity3.h"

#include <cmath>

namespace pangaea {

Similarity3d::Similarity3d(double scale, const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation)
    : scale_(scale), rotation_(rotation.normalized()), translation_(translation) {
  if (rotation_.w() < 0.0) rotation_.coeffs() = -rotation_.coeffs();
}

std::optional<Similarity3d> Similarity3d::FromNormalized(double scale, const Eigen::Quaterniond& rotation,
                                                         const Eigen::Vector3d& translation) {
  const auto rigid = Rigid3d::FromNormalized(rotation, translation);
  if (!rigid || !std::isfinite(scale) || !(scale > 0.0)) return std::nullopt;
  Similarity3d similarity;
  similarity.scale_ = scale;
  similarity.rotation_ = rotation;
  similarity.translation_ = translation;
  return similarity;
}

Similarity3d Similarity3d::Inverse() const {
  const Eigen::Quaterniond inverse = rotation_.conjugate();
  return Similarity3d(1.0 / scale_, inverse, -(inverse * translation_) / scale_);
}

Similarity3d Similarity3d::operator*(const Similarity3d& other) const {
  return Similarity3d(scale_ * other.scale_, rotation_ * other.rotation_,
                      scale_ * (rotation_ * other.translation_) + translation_);
}

Rigid3d Similarity3d::TransformCamera(const Rigid3d& camera_from_source) const {
  const Eigen::Quaterniond camera_from_target = camera_from_source.rotation() * rotation_.conjugate();
  return Rigid3d(camera_from_target, scale_ * camera_from_source.translation() - camera_from_target * translation_);
}

bool Similarity3d::AllFinite() const {
  return std::isfinite(scale_) && rotation_.coeffs().allFinite() && translation_.allFinite();
}

}  // namespace pangaea
