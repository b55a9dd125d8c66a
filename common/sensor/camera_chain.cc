#include "common/sensor/camera_chain.h"

#include <string>

#include "common/base/config.h"
#include "common/sensor/camera_calibration.h"

namespace pangaea {
namespace {

constexpr double kRectifiedAngle = 1e-3;     // radians: half a pixel at a focal length of 500 pixels
constexpr double kRectifiedSideways = 1e-3;  // of the baseline

LensKeys KeysOf(const std::string& camera) {
  return {camera + ".camera_model", camera + ".resolution", camera + ".intrinsics", camera + ".distortion_model",
          camera + ".distortion_coeffs"};
}

void ReadLeft(ConfigReader& reader, CameraRig& rig) {
  RequireLens(reader, KeysOf("cam0"), rig.left);
  if (!reader.Has("cam0.T_cam_imu")) return;  // the body is then the left camera itself
  Rigid3d camera_from_body;
  RequirePose(reader, "cam0.T_cam_imu", camera_from_body);
  rig.body_from_left = camera_from_body.Inverse();
}

void ReadRight(ConfigReader& reader, CameraRig& rig) {
  RequireLens(reader, KeysOf("cam1"), rig.right.emplace());
  const bool through_body = reader.Has("cam0.T_cam_imu") && reader.Has("cam1.T_cam_imu");
  Rigid3d right_from_other;
  RequirePose(reader, through_body ? "cam1.T_cam_imu" : "cam1.T_cn_cnm1", right_from_other);
  rig.body_from_right = through_body ? right_from_other.Inverse() : rig.body_from_left * right_from_other.Inverse();
}

}  // namespace

Status CheckRectified(const CameraRig& rig) {
  if (!rig.right) return {};
  const Rigid3d left_from_right = rig.body_from_left.Inverse() * rig.body_from_right;
  const Eigen::Vector3d& offset = left_from_right.translation();
  const double angle = left_from_right.rotation().angularDistance(Eigen::Quaterniond::Identity());
  const char* wrong = nullptr;
  if (rig.left.is_distorted() || rig.right->is_distorted()) wrong = "a lens has distortion";
  if (!(rig.left == *rig.right)) wrong = "the two cameras have different sizes or intrinsics";
  if (angle > kRectifiedAngle) wrong = "the two cameras are turned against each other";
  if (offset.x() <= 0.0 || offset.tail<2>().norm() > kRectifiedSideways * offset.x()) {
    wrong = "the second camera is not straight to the right of the first one";
  }
  if (wrong == nullptr) return {};
  return Fail(ErrorCode::kInvalidArgument, wrong);
}

Result<CameraRig> ReadCameraChain(const std::filesystem::path& file, SensorKind kind) {
  auto reader = ConfigReader::Open(file);
  if (!reader) return tl::make_unexpected(reader.error());
  CameraRig rig;
  ReadLeft(*reader, rig);
  if (kind == SensorKind::kStereo) ReadRight(*reader, rig);
  reader->Read("rectified", &rig.already_rectified);
  if (auto status = reader->FinishIgnoringUnknown(); !status) return tl::make_unexpected(status.error());
  if (const auto status = CheckRectified(rig); rig.already_rectified && !status) {
    reader->Refuse("rectified", "is true, but " + status.error().message,
                   "true only for equal cameras without distortion, the second displaced along x alone");
    return tl::make_unexpected(reader->FinishIgnoringUnknown().error());
  }
  return rig;
}

}  // namespace pangaea
