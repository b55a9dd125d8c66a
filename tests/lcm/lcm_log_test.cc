// Recordings written to LCM logs and read back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>

#include "common/base/text.h"
#include "common/lcm/lcm_input.h"
#include "common/lcm/recording_publisher.h"
#include "tests/sensor/recording.h"
#include "tests/sensor/temporary_folder.h"

namespace pangaea {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

using testing::kRecordedFrames;
using testing::RecordedStamp;

class LcmLog : public ::testing::Test {
 protected:
  LcmLog() {
    testing::WriteEurocRecording(recording_);
    dataset_ = OpenDataset(recording_, SensorKind::kStereo).value();
  }

  void Write(const RecordingPublisher::Options& options = {}) {
    auto sender = LcmSender::Open(LcmUrl{.network = {}, .log = log_});
    ASSERT_TRUE(sender) << sender.error().message;
    RecordingPublisher publisher(dataset_, **sender, options);
    for (const DatasetFrame& frame : dataset_.frames) EXPECT_TRUE(publisher.Publish(frame));
    EXPECT_TRUE((*sender)->Close());
    published_ = publisher.published();
    skipped_ = publisher.skipped();
  }

  LcmInputOptions Options() const { return {.url = "file://" + log_.string(), .channels = {}, .calibration = {}}; }

  testing::TemporaryFolder folder_;
  fs::path recording_ = folder_.path() / "flight";
  fs::path log_ = folder_.path() / "flight.lcm";
  Dataset dataset_;
  std::size_t published_ = 0;
  std::size_t skipped_ = 0;
};

// What a stream holds: whole frames whose images are those of the recording, and the errors between them.
struct Content {
  std::vector<std::int64_t> stamps;
  std::vector<std::string> errors;
};

bool Same(const Result<cv::Mat>& a, const Result<cv::Mat>& b) {
  return a && b && a->size() == b->size() && cv::norm(*a, *b, cv::NORM_INF) == 0.0;
}

Content ReadAll(FrameStream& stream, const Dataset& dataset) {
  Content content;
  CameraInput original = InputFrom(dataset);
  auto expected = original.frames->Next({});
  while (const auto frame = stream.Next({})) {
    if (!*frame) {
      content.errors.push_back(frame->error().message);
      continue;
    }
    content.stamps.push_back((*frame)->stamp_ns);
    while (expected && (*expected)->stamp_ns < (*frame)->stamp_ns) expected = original.frames->Next({});
    if (!expected) break;
    EXPECT_TRUE(Same((*frame)->left(), (*expected)->left()));
    EXPECT_TRUE(Same((*frame)->right(), (*expected)->right()));
  }
  return content;
}

TEST_F(LcmLog, ARecordingComesBackFromItsLogAsItWas) {
  for (const bool files : {false, true}) {
    Write({.channels = {}, .send_files = files});
    const auto input = OpenLcmInput(Options(), SensorKind::kStereo, {});
    ASSERT_TRUE(input) << input.error().message;
    EXPECT_EQ(input->name, "flight");
    EXPECT_FALSE(input->frames->is_live());
    EXPECT_EQ(input->rig.left, dataset_.rig.left);
    EXPECT_EQ(input->rig.body_from_right.translation(), dataset_.rig.body_from_right.translation());
    const Content content = ReadAll(*input->frames, dataset_);
    ASSERT_EQ(content.stamps.size(), std::size_t{kRecordedFrames});
    EXPECT_EQ(content.stamps[3], RecordedStamp(3)) << "to the nanosecond";
    EXPECT_TRUE(content.errors.empty());
    EXPECT_EQ(input->frames->missing(), 0U);
  }
}

TEST_F(LcmLog, TwoChannelsDoAsWellAsPairs) {
  LcmChannels channels;
  channels.images = "LEFT";
  channels.right_images = "RIGHT";
  Write({.channels = channels});
  LcmInputOptions options = Options();
  options.channels = channels;
  const auto input = OpenLcmInput(options, SensorKind::kStereo, {});
  ASSERT_TRUE(input) << input.error().message;
  EXPECT_EQ(ReadAll(*input->frames, dataset_).stamps.size(), std::size_t{kRecordedFrames});
}

TEST_F(LcmLog, ACalibrationFileTakesThePlaceOfTheMessage) {
  Write();
  LcmInputOptions options = Options();
  options.calibration = folder_.path() / "camera.yaml";
  testing::WriteText(options.calibration,
                     "cam0: {resolution: [64, 48], intrinsics: [55, 55, 31, 24], distortion_model: none}\n");
  const auto input = OpenLcmInput(options, SensorKind::kMonocular, {});
  ASSERT_TRUE(input) << input.error().message;
  EXPECT_EQ(input->rig.left.focal_x, 55.0);
}

TEST_F(LcmLog, ALogWithoutACalibrationIsAnError) {
  Write();
  LcmInputOptions options = Options();
  options.channels.calibration = "NOBODY";
  EXPECT_THAT(OpenLcmInput(options, SensorKind::kStereo, {}).error().message,
              HasSubstr("no calibration came on channel NOBODY"));
}

TEST_F(LcmLog, AnImageThatCannotBeReadIsLeftOutOfTheLogAndCounted) {
  fs::remove(dataset_.frames[2].right);
  Write();
  EXPECT_EQ(published_, std::size_t{kRecordedFrames - 1});
  EXPECT_EQ(skipped_, 1U);
  const auto input = OpenLcmInput(Options(), SensorKind::kStereo, {});
  ASSERT_TRUE(input);
  EXPECT_EQ(ReadAll(*input->frames, dataset_).stamps.size(), std::size_t{kRecordedFrames - 1});
  EXPECT_EQ(input->frames->missing(), 0U);
}

TEST_F(LcmLog, ATruncatedLogGivesItsWholeFramesAndOneError) {
  Write();
  fs::resize_file(log_, fs::file_size(log_) - 1000);
  const auto input = OpenLcmInput(Options(), SensorKind::kStereo, {});
  ASSERT_TRUE(input) << input.error().message;
  const Content content = ReadAll(*input->frames, dataset_);
  EXPECT_EQ(content.stamps.size(), std::size_t{kRecordedFrames - 1});
  ASSERT_EQ(content.errors.size(), 1U);
  EXPECT_THAT(content.errors[0], HasSubstr("flight.lcm: truncated or damaged from octet"));
}

// Where the event of a frame begins in the log: eight magic and counting octets before its stamp are looked for.
std::size_t EventOf(const std::string& log, int frame) {
  std::string stamp(8, '\0');
  const auto microseconds = static_cast<std::uint64_t>(RecordedStamp(frame) / 1000);
  for (std::size_t i = 0; i < 8; ++i) stamp[i] = static_cast<char>(microseconds >> (56U - 8U * i));
  return log.find(stamp, frame == 0 ? log.find(stamp) + 1 : 0) - 12;
}

TEST_F(LcmLog, DamageInTheMiddleCostsItsFramesAlone) {
  Write();
  std::string log = *ReadTextFile(log_);
  const std::size_t event = EventOf(log, 4);
  ASSERT_EQ(static_cast<unsigned char>(log[event]), 0xEDU) << "the test does not know where events begin";
  // The length of the data: far beyond the file.
  log[event + 24] = '\x7F';
  std::ofstream(log_, std::ios::binary) << log;
  const auto input = OpenLcmInput(Options(), SensorKind::kStereo, {});
  ASSERT_TRUE(input) << input.error().message;
  const Content content = ReadAll(*input->frames, dataset_);
  EXPECT_EQ(content.stamps.size(), std::size_t{kRecordedFrames - 1});
  EXPECT_EQ(content.errors.size(), 1U);
  EXPECT_EQ(input->frames->missing(), 1U) << "the gap in the sequence";
}

TEST_F(LcmLog, NoiseIsNoLogAndDoesNoHarm) {
  std::string noise;
  for (int i = 0; i < 100'000; ++i) noise += static_cast<char>(i * 7919 >> 3);
  std::ofstream(log_, std::ios::binary) << noise;
  EXPECT_THAT(OpenLcmInput(Options(), SensorKind::kStereo, {}).error().message, HasSubstr("no calibration came"));
}

TEST_F(LcmLog, WrongAddressesAreErrorsThatSayWhatIsAllowed) {
  LcmInputOptions options;
  for (const char* url : {"", "tcpq://localhost:7700", "file://", "udp://1"}) {
    options.url = url;
    EXPECT_THAT(OpenLcmInput(options, SensorKind::kStereo, {}).error().message, HasSubstr("allowed: udpm://"));
  }
  options.url = "file:///there/is/none.lcm";
  EXPECT_THAT(OpenLcmInput(options, SensorKind::kStereo, {}).error().message, HasSubstr("there is no such LCM log"));
  EXPECT_FALSE(LcmSender::Open(LcmUrl{.network = {}, .log = "/there/is/none.lcm"}));
  options.channels.images = std::string(64, 'x');
  EXPECT_THAT(OpenLcmInput(options, SensorKind::kStereo, {}).error().message, HasSubstr("1 to 63 characters"));
}

TEST(LcmUrl, TheReceiveBufferIsLargeUnlessItIsGiven) {
  EXPECT_EQ(LcmUrl::Parse("udpm://239.255.76.67:7667")->network, "udpm://239.255.76.67:7667?recv_buf_size=4000000");
  EXPECT_EQ(LcmUrl::Parse("udpm://a:1?ttl=1")->network, "udpm://a:1?ttl=1&recv_buf_size=4000000");
  EXPECT_EQ(LcmUrl::Parse("udpm://a:1?recv_buf_size=9")->network, "udpm://a:1?recv_buf_size=9");
  EXPECT_EQ(LcmUrl::Parse("file://x/y.lcm?speed=0")->log, "x/y.lcm");
}

}  // namespace
}  // namespace pangaea
