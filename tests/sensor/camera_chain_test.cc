#include "common/sensor/camera_chain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/sensor/recording.h"
#include "tests/sensor/temporary_folder.h"

namespace pangaea {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// As Kalibr writes it: flow lists, matrices as lists of rows, keys that are not for us.
constexpr const char* kChain = R"(cam0:
  T_cam_imu:
  - [0.0, 1.0, 0.0, 0.1]
  - [-1.0, 0.0, 0.0, 0.2]
  - [0.0, 0.0, 1.0, 0.3]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [0.003, 0.0007, -0.002, 0.0002]
  distortion_model: equidistant
  intrinsics: [190.9, 190.8, 254.9, 256.8]
  resolution: [512, 512]
  rostopic: /cam0/image_raw
cam1:
  T_cam_imu:
  - [0.0, 1.0, 0.0, 0.0]
  - [-1.0, 0.0, 0.0, 0.2]
  - [0.0, 0.0, 1.0, 0.3]
  - [0.0, 0.0, 0.0, 1.0]
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.1]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  distortion_coeffs: [0.003, 0.0007, -0.002, 0.0001]
  distortion_model: equidistant
  intrinsics: [190.5, 190.4, 252.5, 254.9]
  resolution: [512, 512]
)";

class CameraChain : public ::testing::Test {
 protected:
  CameraChain() { testing::WriteText(file_, kChain); }

  std::string Message(SensorKind kind = SensorKind::kStereo) const {
    const auto rig = ReadCameraChain(file_, kind);
    return rig ? "accepted" : rig.error().message;
  }

  testing::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "camchain.yaml";
};

TEST_F(CameraChain, BothCamerasAndTheirPlaceOnTheBodyAreRead) {
  const auto rig = ReadCameraChain(file_, SensorKind::kStereo);
  ASSERT_TRUE(rig) << rig.error().message;
  EXPECT_EQ(rig->left.kind, LensKind::kEquidistant);
  EXPECT_EQ(rig->left.width, 512);
  EXPECT_EQ(rig->left.focal_y, 190.8);
  EXPECT_EQ(rig->left.center_x, 254.9);
  EXPECT_EQ(rig->left.coefficients[3], 0.0002);
  EXPECT_EQ(rig->right->coefficients[3], 0.0001);
  // The body's origin is at (0.1, 0.2, 0.3) in the left camera.
  EXPECT_LT((rig->body_from_left * Eigen::Vector3d(0.1, 0.2, 0.3)).norm(), 1e-12);
  const Rigid3d left_from_right = rig->body_from_left.Inverse() * rig->body_from_right;
  EXPECT_LT((left_from_right.translation() - Eigen::Vector3d(0.1, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_FALSE(rig->already_rectified);
}

TEST_F(CameraChain, WithoutABodyTheLeftCameraIsTheBodyAndTheChainLeadsToTheRightOne) {
  testing::Replace(file_, "cam0:\n  T_cam_imu", "cam0:\n  T_other");
  const auto rig = ReadCameraChain(file_, SensorKind::kStereo);
  ASSERT_TRUE(rig) << rig.error().message;
  EXPECT_LT(rig->body_from_left.Log().norm(), 1e-12);
  EXPECT_LT((rig->body_from_right.translation() - Eigen::Vector3d(0.1, 0.0, 0.0)).norm(), 1e-12);
}

TEST_F(CameraChain, AMonocularSensorNeedsOneCamera) {
  testing::Replace(file_, "cam1:", "another:");
  EXPECT_EQ(Message(SensorKind::kMonocular), "accepted");
  EXPECT_THAT(Message(), HasSubstr("the key cam1.resolution is missing"));
}

TEST_F(CameraChain, EveryThingThatIsWrongIsNamedWithFileLineKeyAndRange) {
  testing::Replace(file_, "intrinsics: [190.9,", "intrinsics: [-190.9,");
  testing::Replace(file_, "distortion_model: equidistant", "distortion_model: fov");
  testing::Replace(file_, "resolution: [512, 512]\n  rostopic", "resolution: [512]\n  rostopic");
  testing::Replace(file_, "- [1.0, 0.0, 0.0, -0.1]", "- [1.5, 0.0, 0.0, -0.1]");
  testing::Replace(file_, "cam1:\n  T_cam_imu", "cam1:\n  T_other");
  const std::string message = Message();
  EXPECT_THAT(message, HasSubstr(file_.string() + ":11: cam0.intrinsics: number 1 is '-190.9'; allowed: 4 numbers"));
  EXPECT_THAT(message, AllOf(HasSubstr(":10: cam0.distortion_model is 'fov'"), HasSubstr("equidistant or none")));
  EXPECT_THAT(message, HasSubstr(":12: cam0.resolution has 1 numbers"));
  EXPECT_THAT(message, HasSubstr("cam1.T_cn_cnm1 is not a rigid motion"));
}

TEST_F(CameraChain, AnotherCameraModelIsRefused) {
  testing::Replace(file_, "camera_model: pinhole", "camera_model: omni");
  EXPECT_THAT(Message(), HasSubstr("cam0.camera_model is 'omni'; allowed: pinhole"));
}

TEST_F(CameraChain, AMissingFileOrNoYamlIsAnError) {
  EXPECT_THAT(ReadCameraChain(folder_.path() / "none.yaml", SensorKind::kStereo).error().message,
              HasSubstr("none.yaml"));
  testing::WriteText(file_, "cam0: [1, 2");
  EXPECT_THAT(Message(), HasSubstr("not valid YAML"));
}

TEST_F(CameraChain, ImagesThatCannotBeRectifiedAlreadyMayNotBeCalledSo) {
  testing::WriteText(file_, std::string("rectified: true\n") + kChain);
  EXPECT_THAT(Message(), AllOf(HasSubstr(":1: rectified is true, but"), HasSubstr("allowed: true only for")));
  const std::string camera = "  resolution: [640, 480]\n  intrinsics: [500, 500, 320, 240]\n  distortion_model: none\n";
  const std::string pose = "  T_cn_cnm1: [1, 0, 0, -0.12, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n";
  testing::WriteText(file_, "rectified: true\ncam0:\n" + camera + "cam1:\n" + camera + pose);
  const auto rig = ReadCameraChain(file_, SensorKind::kStereo);
  ASSERT_TRUE(rig) << rig.error().message;
  EXPECT_TRUE(rig->already_rectified);
  EXPECT_NEAR(rig->body_from_right.translation().x(), 0.12, 1e-12);
}

}  // namespace
}  // namespace pangaea
