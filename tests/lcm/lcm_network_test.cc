// Live LCM, on loopback.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/lcm/image_codec.h"
#include "common/lcm/lcm_input.h"
#include "common/lcm/recording_publisher.h"
#include "tests/lcm/network.h"
#include "tests/sensor/recording.h"
#include "tests/sensor/temporary_folder.h"

namespace pangaea {
namespace {

class LcmNetwork : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!testing::MulticastWorks()) GTEST_SKIP() << testing::kNoMulticast;
  }

  const std::string url_ = testing::OwnNetwork();
};

TEST_F(LcmNetwork, LargePairsArriveOneForOneAndInOrder) {
  const auto url = LcmUrl::Parse(url_);
  const auto receiver = LcmReceiver::Open(*url, {"IMAGES"});
  const auto sender = LcmSender::Open(*url);
  ASSERT_TRUE(receiver && sender);
  const testing::Deadline deadline(std::chrono::seconds(60));
  const cv::Mat image(480, 752, CV_8UC1, cv::Scalar(77));
  for (int i = 0; i < 40; ++i) {
    ASSERT_TRUE((*sender)->Send("IMAGES", EncodeImages({ImageMessage(image, i, i), ImageMessage(image, i, i)}), i));
    const auto message = (*receiver)->Next(deadline.token());
    ASSERT_TRUE(message && *message) << i;
    const auto images = DecodeImages((*message)->payload);
    ASSERT_TRUE(images) << images.error().message;
    EXPECT_EQ(images->back().sequence, i);
  }
}

TEST_F(LcmNetwork, AnInputWaitsForTheCalibrationAndThenGivesFrames) {
  testing::TemporaryFolder folder;
  testing::WriteEurocRecording(folder.path());
  const Dataset dataset = OpenDataset(folder.path(), SensorKind::kStereo).value();
  const auto sender = LcmSender::Open(*LcmUrl::Parse(url_));
  ASSERT_TRUE(sender);
  const testing::Deadline deadline(std::chrono::seconds(60));
  // A camera that is on before the agent and goes on until the agent has seen enough.
  std::jthread camera([&](const std::stop_token& enough) {
    RecordingPublisher publisher(dataset, **sender, {});
    DatasetFrame frame = dataset.frames.front();
    while (!enough.stop_requested() && !deadline.token().stop_requested()) {
      EXPECT_TRUE(publisher.Publish(frame));
      frame.stamp_ns += 50'000'000;
    }
  });
  const LcmInputOptions options{.url = url_, .channels = {}, .calibration = {}};
  const auto input = OpenLcmInput(options, SensorKind::kStereo, deadline.token());
  ASSERT_TRUE(input) << input.error().message;
  EXPECT_TRUE(input->frames->is_live());
  std::int64_t latest = 0;
  for (int i = 0; i < 5; ++i) {
    const auto frame = input->frames->Next(deadline.token());
    ASSERT_TRUE(frame && *frame);
    EXPECT_GT((*frame)->stamp_ns, latest);
    latest = (*frame)->stamp_ns;
    EXPECT_TRUE((*frame)->right());
  }
}

TEST_F(LcmNetwork, AStopEndsTheWaiting) {
  std::stop_source stop;
  stop.request_stop();
  const LcmInputOptions options{.url = url_, .channels = {}, .calibration = {}};
  EXPECT_THAT(OpenLcmInput(options, SensorKind::kStereo, stop.get_token()).error().message,
              ::testing::HasSubstr("no calibration came"));
}

}  // namespace
}  // namespace pangaea
