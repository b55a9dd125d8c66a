#include "common/lcm/calibration_codec.h"

#include <algorithm>
#include <optional>
#include <pangaea_lcm/calibration_t.hpp>
#include <string>

#include "common/lcm/message_codec.h"
#include "common/lcm/pose_codec.h"
#include "common/sensor/camera_chain.h"

namespace pangaea {
namespace {

using pangaea_lcm::calibration_t;
using pangaea_lcm::camera_t;

camera_t CameraMessage(const LensModel& lens, const Rigid3d& body_from_camera) {
  camera_t camera{};
  camera.width = lens.width;
  camera.height = lens.height;
  camera.focal_x = lens.focal_x;
  camera.focal_y = lens.focal_y;
  camera.center_x = lens.center_x;
  camera.center_y = lens.center_y;
  const bool is_equidistant = lens.kind == LensKind::kEquidistant;
  camera.lens = is_equidistant ? int{camera_t::EQUIDISTANT} : int{camera_t::RADIAL_TANGENTIAL};
  std::ranges::copy(lens.coefficients, camera.coefficients);
  camera.body_from_camera = PoseMessage(body_from_camera);
  return camera;
}

Error Wrong(const std::string& place, const std::string& what) {
  return {ErrorCode::kInvalidArgument, "calibration message: " + place + what};
}

Result<LensModel> LensOf(const camera_t& camera, const std::string& place) {
  LensModel lens;
  lens.width = camera.width;
  lens.height = camera.height;
  lens.focal_x = camera.focal_x;
  lens.focal_y = camera.focal_y;
  lens.center_x = camera.center_x;
  lens.center_y = camera.center_y;
  std::ranges::copy(camera.coefficients, lens.coefficients.begin());
  if (camera.lens != camera_t::RADIAL_TANGENTIAL && camera.lens != camera_t::EQUIDISTANT) {
    return tl::make_unexpected(
        Wrong(place, ".lens is " + std::to_string(camera.lens) + "; allowed: 0 (RADIAL_TANGENTIAL), 1 (EQUIDISTANT)"));
  }
  lens.kind = camera.lens == camera_t::EQUIDISTANT ? LensKind::kEquidistant : LensKind::kRadialTangential;
  if (auto status = lens.Check("calibration message: " + place); !status) return tl::make_unexpected(status.error());
  return lens;
}

Result<Rigid3d> PoseOf(const camera_t& camera, const std::string& place) {
  const auto pose = RigidOf(camera.body_from_camera);
  if (pose) return *pose;
  return tl::make_unexpected(
      Wrong(place, ".body_from_camera is not a rigid motion; allowed: metres and a unit quaternion w, x, y, z"));
}

Status ReadCamera(const camera_t& camera, const std::string& place, LensModel& lens, Rigid3d& body_from_camera) {
  auto read_lens = LensOf(camera, place);
  if (!read_lens) return tl::make_unexpected(read_lens.error());
  auto pose = PoseOf(camera, place);
  if (!pose) return tl::make_unexpected(pose.error());
  lens = *read_lens;
  body_from_camera = *pose;
  return {};
}

}  // namespace

std::vector<std::byte> EncodeCalibration(const CameraRig& rig) {
  calibration_t message{};
  message.rectified = rig.already_rectified ? 1 : 0;
  message.camera_count = rig.right ? 2 : 1;
  message.cameras[0] = CameraMessage(rig.left, rig.body_from_left);
  if (rig.right) message.cameras[1] = CameraMessage(*rig.right, rig.body_from_right);
  return EncodeMessage(message);
}

Result<CameraRig> DecodeCalibration(std::span<const std::byte> payload, SensorKind kind) {
  const auto message = DecodeMessage<calibration_t>(payload);
  if (!message) return tl::make_unexpected(message.error());
  const int needed = kind == SensorKind::kStereo ? 2 : 1;
  if (message->camera_count < needed || message->camera_count > 2) {
    return tl::make_unexpected(Wrong("camera_count", " is " + std::to_string(message->camera_count) +
                                                         "; allowed: " + (needed == 2 ? "2 for stereo" : "1 or 2")));
  }
  CameraRig rig;
  if (auto status = ReadCamera(message->cameras[0], "cameras[0]", rig.left, rig.body_from_left); !status) {
    return tl::make_unexpected(status.error());
  }
  if (kind == SensorKind::kStereo) {
    const auto status = ReadCamera(message->cameras[1], "cameras[1]", rig.right.emplace(), rig.body_from_right);
    if (!status) return tl::make_unexpected(status.error());
  }
  rig.already_rectified = message->rectified != 0;
  if (auto status = CheckRectified(rig); rig.already_rectified && !status) {
    return tl::make_unexpected(Wrong("rectified", " is set, but " + status.error().message));
  }
  return rig;
}

}  // namespace pangaea
