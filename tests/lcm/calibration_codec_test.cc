#include "common/lcm/calibration_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <pangaea_lcm/calibration_t.hpp>
#include <random>

#include "common/lcm/message_codec.h"
#include "tests/sensor/rigs.h"

namespace pangaea {
namespace {

using pangaea_lcm::calibration_t;
using ::testing::HasSubstr;

TEST(LcmCalibrationCodec, ARigComesBackWithExactlyTheSameNumbers) {
  for (const CameraRig& rig : {testing::DroneRig(), testing::FisheyeRig()}) {
    const auto back = DecodeCalibration(EncodeCalibration(rig), SensorKind::kStereo);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->left, rig.left);
    EXPECT_EQ(*back->right, *rig.right);
    EXPECT_EQ(back->body_from_left.rotation().coeffs(), rig.body_from_left.rotation().coeffs());
    EXPECT_EQ(back->body_from_right.translation(), rig.body_from_right.translation());
    EXPECT_FALSE(back->already_rectified);
  }
}

TEST(LcmCalibrationCodec, AMonocularSensorTakesTheLeftCamera) {
  CameraRig rig = testing::FisheyeRig();
  EXPECT_FALSE(DecodeCalibration(EncodeCalibration(rig), SensorKind::kMonocular)->right);
  rig.right.reset();
  EXPECT_TRUE(DecodeCalibration(EncodeCalibration(rig), SensorKind::kMonocular));
  EXPECT_THAT(DecodeCalibration(EncodeCalibration(rig), SensorKind::kStereo).error().message,
              HasSubstr("camera_count is 1; allowed: 2 for stereo"));
}

// What is refused of a calibration that a test spoiled.
std::string Refusal(const std::function<void(calibration_t&)>& spoil) {
  auto message = *DecodeMessage<calibration_t>(EncodeCalibration(testing::DroneRig()));
  spoil(message);
  const auto rig = DecodeCalibration(EncodeMessage(message), SensorKind::kStereo);
  return rig ? "accepted" : rig.error().message;
}

TEST(LcmCalibrationCodec, ImpossibleValuesAreRefusedAndNamed) {
  EXPECT_EQ(Refusal([](calibration_t&) {}), "accepted");
  EXPECT_THAT(Refusal([](calibration_t& c) { c.camera_count = 3; }), HasSubstr("camera_count is 3"));
  EXPECT_THAT(Refusal([](calibration_t& c) { c.cameras[1].width = -5; }),
              HasSubstr("cameras[1]: the image size is -5"));
  EXPECT_THAT(Refusal([](calibration_t& c) { c.cameras[0].focal_x = 0.0; }),
              HasSubstr("cameras[0]: the focal lengths"));
  EXPECT_THAT(
      Refusal([](calibration_t& c) { c.cameras[0].coefficients[2] = std::numeric_limits<double>::quiet_NaN(); }),
      HasSubstr("is not finite"));
  EXPECT_THAT(Refusal([](calibration_t& c) { c.cameras[1].lens = 9; }), HasSubstr("cameras[1].lens is 9; allowed: 0"));
  EXPECT_THAT(Refusal([](calibration_t& c) { c.cameras[0].body_from_camera.rotation[0] = 2.0; }),
              HasSubstr("cameras[0].body_from_camera is not a rigid motion"));
  EXPECT_THAT(Refusal([](calibration_t& c) {
                c.cameras[0].body_from_camera.position[1] = std::numeric_limits<double>::infinity();
              }),
              HasSubstr("not a rigid motion"));
  EXPECT_THAT(Refusal([](calibration_t& c) { c.rectified = 1; }), HasSubstr("rectified is set, but"));
}

TEST(LcmCalibrationCodec, TruncatedAndDamagedMessagesNeverDoHarm) {
  const auto whole = EncodeCalibration(testing::DroneRig());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(DecodeCalibration(std::span(whole).first(size), SensorKind::kStereo));
  }
  std::mt19937 random(3);
  for (int round = 0; round < 2000; ++round) {
    auto damaged = whole;
    damaged[random() % damaged.size()] = static_cast<std::byte>(random());
    const auto rig = DecodeCalibration(damaged, SensorKind::kStereo);
    EXPECT_TRUE(!rig || rig->body_from_left.AllFinite());
  }
}

}  // namespace
}  // namespace pangaea
