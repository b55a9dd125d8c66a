#include "common/sensor/video_input.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/videoio.hpp>

#include "tests/sensor/recording.h"
#include "tests/sensor/temporary_folder.h"

namespace pangaea {
namespace {

using ::testing::HasSubstr;

constexpr int kFrames = 12;
constexpr double kRate = 20.0;

std::string Camera(const std::string& name, int width) {
  return name + ":\n  resolution: [" + std::to_string(width) + ", 48]\n  intrinsics: [60, 60, 31, 24]\n" +
         "  distortion_model: none\n";
}
constexpr const char* kRightPose = "  T_cn_cnm1: [1, 0, 0, -0.1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n";

// Frame i is grey of 10 + 15 i, its right half 5 brighter.
class VideoInput : public ::testing::Test {
 protected:
  VideoInput() {
    cv::VideoWriter writer(video_, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), kRate, cv::Size(128, 48));
    EXPECT_TRUE(writer.isOpened());
    for (int i = 0; i < kFrames; ++i) {
      cv::Mat frame(48, 128, CV_8UC3, cv::Scalar::all(10 + 15 * i));
      frame.colRange(64, 128).setTo(cv::Scalar::all(15 + 15 * i));
      writer.write(frame);
    }
    testing::WriteText(stereo_, Camera("cam0", 64) + Camera("cam1", 64) + kRightPose);
    testing::WriteText(mono_, Camera("cam0", 128));
  }

  std::string Refusal(const std::string& source, const std::filesystem::path& calibration,
                      SensorKind kind = SensorKind::kMonocular) const {
    const auto input = OpenVideoInput(source, calibration, kind);
    return input ? "accepted" : input.error().message;
  }

  testing::TemporaryFolder folder_;
  std::string video_ = (folder_.path() / "hall.avi").string();
  std::filesystem::path stereo_ = folder_.path() / "stereo.yaml";
  std::filesystem::path mono_ = folder_.path() / "mono.yaml";
};

TEST_F(VideoInput, EveryFrameComesWithItsTime) {
  const auto input = OpenVideoInput(video_, mono_, SensorKind::kMonocular);
  ASSERT_TRUE(input) << input.error().message;
  EXPECT_EQ(input->name, "hall");
  EXPECT_FALSE(input->frames->is_live());
  std::int64_t first = 0;
  for (int i = 0; i < kFrames; ++i) {
    const auto frame = input->frames->Next({});
    ASSERT_TRUE(frame && *frame) << i;
    if (i == 0) first = (*frame)->stamp_ns;
    EXPECT_NEAR(static_cast<double>((*frame)->stamp_ns - first), 1e9 * i / kRate, 1e6);
    const auto image = (*frame)->left();
    ASSERT_TRUE(image) << image.error().message;
    EXPECT_EQ(image->type(), CV_8UC1);
    EXPECT_EQ(image->size(), cv::Size(128, 48));
    EXPECT_NEAR(cv::mean(*image)[0], 12.5 + 15 * i, 2.0);
    EXPECT_FALSE((*frame)->right);
  }
  EXPECT_FALSE(input->frames->Next({}));
}

TEST_F(VideoInput, StereoImagesLieSideBySide) {
  const auto input = OpenVideoInput(video_, stereo_, SensorKind::kStereo);
  ASSERT_TRUE(input) << input.error().message;
  const auto frame = input->frames->Next({});
  ASSERT_TRUE(frame && *frame);
  const auto left = (*frame)->left();
  const auto right = (*frame)->right();
  ASSERT_TRUE(left && right);
  EXPECT_EQ(left->size(), cv::Size(64, 48));
  EXPECT_EQ(right->size(), cv::Size(64, 48));
  EXPECT_NEAR(cv::mean(*right)[0] - cv::mean(*left)[0], 5.0, 1.5);
}

TEST_F(VideoInput, AStopEndsIt) {
  const auto input = OpenVideoInput(video_, mono_, SensorKind::kMonocular);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(input->frames->Next(stop.get_token()));
}

TEST_F(VideoInput, ATruncatedVideoDoesNoHarm) {
  std::filesystem::resize_file(video_, std::filesystem::file_size(video_) / 2);
  const auto input = OpenVideoInput(video_, mono_, SensorKind::kMonocular);
  if (!input) return;  // the demuxer may refuse it, but not crash
  int frames = 0;
  while (const auto frame = input->frames->Next({})) ++frames;
  EXPECT_LT(frames, kFrames);
}

TEST_F(VideoInput, WhatCannotBeOpenedIsAnErrorThatSaysWhy) {
  EXPECT_THAT(Refusal((folder_.path() / "none.avi").string(), mono_), HasSubstr("there is no such video"));
  EXPECT_THAT(Refusal(video_, {}), HasSubstr("needs a calibration file"));
  EXPECT_THAT(Refusal(video_, folder_.path() / "none.yaml"), HasSubstr("none.yaml"));
  EXPECT_THAT(Refusal("999", mono_), HasSubstr("camera 999 cannot be opened"));
  const auto noise = folder_.path() / "noise.avi";
  std::ofstream(noise) << "this is no video";
  EXPECT_THAT(Refusal(noise.string(), mono_), HasSubstr("not a video that can be read"));
}

TEST_F(VideoInput, ACalibrationOfAnotherSizeIsAnErrorWithFileKeyAndBothSizes) {
  EXPECT_THAT(Refusal(video_, stereo_), HasSubstr("stereo.yaml: cam0.resolution asks for frames of 64 x 48, but those "
                                                  "of " +
                                                  video_ + " are 128 x 48"));
  testing::WriteText(stereo_, Camera("cam0", 128) + Camera("cam1", 128) + kRightPose);
  EXPECT_THAT(Refusal(video_, stereo_, SensorKind::kStereo), HasSubstr("256 x 48 (both images side by side)"));
}

}  // namespace
}  // namespace pangaea
