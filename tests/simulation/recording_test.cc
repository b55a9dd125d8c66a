#include "common/simulation/recording.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <set>

namespace pangaea {
namespace {

RecordingOptions Short() {
  RecordingOptions options;
  options.sessions = 2;
  options.seconds = 0.5;
  options.coarseness = 4.0;  // sooner ready
  return options;
}

bool AreEqual(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0.0; }

const Recording& ShortRecording() {
  static const Recording recording(Short());
  return recording;
}

TEST(Recording, GroundTruthHasEveryImageStampAndTwoHundredAPerSecond) {
  for (const double rate : {20.0, 30.0}) {
    RecordingOptions options = Short();
    options.sessions = 1;
    options.rate = rate;
    const Recording recording(options);
    std::set<std::int64_t> stamps;
    std::int64_t last = 0;
    for (const TruthSample& sample : recording.GroundTruth(0)) {
      EXPECT_GT(sample.stamp_ns, last);
      if (last != 0) {
        EXPECT_LE(sample.stamp_ns - last, 5'000'000);
      }
      last = sample.stamp_ns;
      stamps.insert(sample.stamp_ns);
    }
    ASSERT_EQ(recording.frame_count(), static_cast<int>(0.5 * rate));
    for (int i = 0; i < recording.frame_count(); ++i) EXPECT_EQ(stamps.count(recording.FrameStamp(0, i)), 1U);
  }
}

TEST(Recording, OnTheWayBackThePlacesAreTheSameAndTheVelocityIsReversed) {
  RecordingOptions options = Short();
  options.sessions = 1;
  options.laps = 2;
  const Recording recording(options);
  std::map<std::int64_t, TruthSample> truth;
  for (const TruthSample& sample : recording.GroundTruth(0)) truth[sample.stamp_ns] = sample;
  const int last = recording.total_frame_count() - 1;
  for (int i = 1; i < recording.frame_count() - 1; ++i) {
    const TruthSample& out = truth.at(recording.FrameStamp(0, i));
    const TruthSample& back = truth.at(recording.FrameStamp(0, last - i));
    EXPECT_EQ(recording.PictureOf(last - i), i);
    EXPECT_LT((out.world_from_body.translation() - back.world_from_body.translation()).norm(), 1e-6);
    EXPECT_LT((out.velocity_in_world + back.velocity_in_world).norm(), 1e-5);
  }
}

TEST(Recording, AFrameDependsOnNothingButItsNumber) {
  FramePainter one(ShortRecording());
  FramePainter other(ShortRecording());
  one.Paint(1, 7);
  one.Paint(0, 2);
  const StereoPicture a = one.Paint(1, 3);
  const StereoPicture b = other.Paint(1, 3);
  EXPECT_TRUE(AreEqual(a.left, b.left));
  EXPECT_TRUE(AreEqual(a.right, b.right));
  EXPECT_FALSE(AreEqual(a.left, a.right));
}

TEST(Recording, EveryPartOfEveryPictureHasCorners) {
  constexpr int kFastThreshold = 20;
  RecordingOptions options = Short();
  options.coarseness = 1.0;
  const Recording recording(options);
  FramePainter painter(recording);
  for (int session = 0; session < 2; ++session) {
    const StereoPicture picture = painter.Paint(session, 0);
    for (const cv::Mat& image : {picture.left, picture.right}) {
      std::vector<cv::KeyPoint> corners;
      cv::FAST(image, corners, kFastThreshold);
      EXPECT_GT(corners.size(), 1000U);
      for (int cell = 0; cell < 12; ++cell) {
        const cv::Rect2f area(static_cast<float>(188 * (cell % 4)), static_cast<float>(160 * (cell / 4)), 188, 160);
        EXPECT_GT(std::count_if(corners.begin(), corners.end(),
                                [&](const cv::KeyPoint& corner) { return area.contains(corner.pt); }),
                  15);
      }
    }
  }
}

TEST(Recording, ABlackoutShowsNothingButNoise) {
  RecordingOptions options = Short();
  options.sessions = 1;
  options.sensor = SensorKind::kMonocular;
  options.blackouts = {{0.1, 0.2}};
  const Recording recording(options);
  FramePainter painter(recording);
  EXPECT_GT(cv::mean(painter.Paint(0, 0).left)[0], 40.0);
  EXPECT_LT(cv::mean(painter.Paint(0, 2).left)[0], 8.0);
  EXPECT_FALSE(AreEqual(painter.Paint(0, 2).left, painter.Paint(0, 3).left));
  EXPECT_GT(cv::mean(painter.Paint(0, 4).left)[0], 40.0);
  EXPECT_TRUE(painter.Paint(0, 0).right.empty());
}

TEST(Recording, BlurAndExposureChangeThePicture) {
  const cv::Mat plain = FramePainter(ShortRecording()).Paint(0, 2).left;
  RecordingOptions blurred = Short();
  blurred.blur = 4;
  blurred.exposure_time = 0.04;
  const Recording blurred_recording(blurred);
  RecordingOptions drifting = Short();
  drifting.exposure_drift = 0.8;
  const Recording drifting_recording(drifting);
  for (const Recording* recording : {&blurred_recording, &drifting_recording}) {
    EXPECT_GT(cv::norm(plain, FramePainter(*recording).Paint(0, 2).left, cv::NORM_L1) / (752.0 * 480.0), 0.5);
  }
}

TEST(Recording, OccludersWalkThroughThePictureAndLeaveTheRestAsItWas) {
  RecordingOptions options = Short();
  options.seconds = 8.0;
  options.rate = 1.0;
  const Recording empty(options);
  options.occluders = 12;
  const Recording busy(options);
  FramePainter of_empty(empty);
  FramePainter of_busy(busy);
  double hidden = 0.0;
  for (int frame = 0; frame < 8; ++frame) {
    const cv::Mat changed = of_empty.Paint(0, frame).left != of_busy.Paint(0, frame).left;
    hidden += cv::countNonZero(changed) / (752.0 * 480.0 * 8.0);
  }
  EXPECT_GT(hidden, 0.01);
  EXPECT_LT(hidden, 0.5);
}

TEST(RecordingOptions, OutOfRangeIsRefusedInWords) {
  RecordingOptions options;
  EXPECT_TRUE(options.Check());
  options.sessions = 0;
  EXPECT_FALSE(options.Check());
  options = {};
  options.blackouts = {{5.0, 4.0}};
  ASSERT_FALSE(options.Check());
  EXPECT_NE(options.Check().error().message.find("blackout"), std::string::npos);
}

}  // namespace
}  // namespace pangaea
