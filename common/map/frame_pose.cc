#include "common/map/frame_pose.h"

#include <algorithm>
#include <cmath>

namespace pangaea {
namespace {

using Vector6f = Eigen::Matrix<float, 6, 1>;

Vector6f Compact(const Rigid3d& rigid) {
  Vector6f compact;
  compact << rigid.rotation().vec().cast<float>(), rigid.translation().cast<float>();
  return compact;
}

// The numbers of the vector part are those of a unit quaternion, up to the rounding of float.
std::optional<Rigid3d> Expand(const Vector6f& compact) {
  const Eigen::Vector3d vector = compact.head<3>().cast<double>();
  const double w = std::sqrt(std::max(0.0, 1.0 - vector.squaredNorm()));
  return Rigid3d::FromNormalized(Eigen::Quaterniond(w, vector.x(), vector.y(), vector.z()),
                                 compact.tail<3>().cast<double>());
}

bool SameBits(const Rigid3d& a, const Rigid3d& b) {
  return a.rotation().coeffs() == b.rotation().coeffs() && a.translation() == b.translation();
}

enum Form : std::uint8_t { kCompact = 0, kFull = 1 };

}  // namespace

Rigid3d QuantizeFramePose(const Rigid3d& reference_from_frame) {
  return Expand(Compact(reference_from_frame)).value_or(reference_from_frame);
}

void WriteFramePose(const FramePose& pose, MapWriter& writer) {
  ByteWriter& bytes = writer.bytes();
  bytes.SignedVarint(pose.stamp_ns);
  const bool compact = SameBits(QuantizeFramePose(pose.reference_from_frame), pose.reference_from_frame);
  bytes.Word(static_cast<std::uint8_t>(compact ? kCompact : kFull));
  if (!compact) return writer.WriteRigid(pose.reference_from_frame);
  for (const float value : Compact(pose.reference_from_frame)) bytes.Word(value);
}

FramePose ReadFramePose(MapReader& reader) {
  FramePose pose;
  pose.stamp_ns = reader.bytes().SignedVarint();
  const auto form = reader.bytes().Word<std::uint8_t>();
  if (form > kFull) reader.bytes().Invalidate();
  if (form == kFull) {
    pose.reference_from_frame = reader.ReadRigid();
    return pose;
  }
  Vector6f compact;
  for (float& value : compact) value = reader.bytes().Word<float>();
  const auto rigid = Expand(compact);
  if (!rigid) reader.bytes().Invalidate();
  pose.reference_from_frame = rigid.value_or(Rigid3d());
  return pose;
}

}  // namespace pangaea
