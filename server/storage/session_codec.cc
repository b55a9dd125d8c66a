#include "server/storage/session_codec.h"

#include <array>
#include <cstring>

namespace pangaea {
namespace {

// Width, height, focal_x, focal_y, center_x, center_y, baseline; rotation x, y, z, w; translation x, y, z.
using Rig = std::array<double, 14>;

}  // namespace

std::vector<std::byte> EncodeRig(const SessionAnnouncement& announcement) {
  const IdealCamera& camera = announcement.ideal_camera;
  const Eigen::Quaterniond& rotation = announcement.body_from_camera.rotation();
  const Eigen::Vector3d& translation = announcement.body_from_camera.translation();
  const Rig rig{static_cast<double>(camera.width),
                static_cast<double>(camera.height),
                camera.focal_x,
                camera.focal_y,
                camera.center_x,
                camera.center_y,
                camera.baseline,
                rotation.x(),
                rotation.y(),
                rotation.z(),
                rotation.w(),
                translation.x(),
                translation.y(),
                translation.z()};
  const auto bytes = std::as_bytes(std::span(rig));
  return {bytes.begin(), bytes.end()};
}

Status DecodeRig(std::span<const std::byte> bytes, SessionAnnouncement& announcement) {
  Rig rig;
  if (bytes.size() != sizeof(rig)) return Fail(ErrorCode::kCorrupt, "a session's camera rig is damaged");
  std::memcpy(rig.data(), bytes.data(), sizeof(rig));
  announcement.ideal_camera = {
      static_cast<int>(rig[0]), static_cast<int>(rig[1]), rig[2], rig[3], rig[4], rig[5], rig[6]};
  const Eigen::Quaterniond rotation(rig[10], rig[7], rig[8], rig[9]);
  announcement.body_from_camera = Rigid3d(rotation, {rig[11], rig[12], rig[13]});
  return {};
}

}  // namespace pangaea
