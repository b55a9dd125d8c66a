#include "server/storage/session_codec.h"

#include "common/base/bytes.h"

namespace pangaea {

std::vector<std::byte> EncodeRig(const SessionAnnouncement& announcement) {
  ByteWriter writer;
  const IdealCamera& camera = announcement.ideal_camera;
  for (const int side : {camera.width, camera.height}) writer.Word<std::int32_t>(side);
  for (const double value : {camera.focal_x, camera.focal_y, camera.center_x, camera.center_y, camera.baseline}) {
    writer.Word(value);
  }
  const auto& rotation = announcement.body_from_camera.rotation();
  const auto& translation = announcement.body_from_camera.translation();
  for (const double value : {rotation.x(), rotation.y(), rotation.z(), rotation.w()}) writer.Word(value);
  for (const double value : {translation.x(), translation.y(), translation.z()}) writer.Word(value);
  return writer.Take();
}

Status DecodeRig(std::span<const std::byte> bytes, SessionAnnouncement& announcement) {
  ByteReader reader(bytes);
  IdealCamera& camera = announcement.ideal_camera;
  for (int* side : {&camera.width, &camera.height}) *side = reader.Word<std::int32_t>();
  for (double* value : {&camera.focal_x, &camera.focal_y, &camera.center_x, &camera.center_y, &camera.baseline}) {
    *value = reader.Word<double>();
  }
  double pose[7];
  for (double& value : pose) value = reader.Word<double>();
  if (!reader.ok() || reader.remaining() != 0) return Fail(ErrorCode::kCorrupt, "a session's camera rig is damaged");
  const Eigen::Quaterniond rotation(pose[3], pose[0], pose[1], pose[2]);
  announcement.body_from_camera = Rigid3d(rotation, {pose[4], pose[5], pose[6]});
  return {};
}

}  // namespace pangaea
