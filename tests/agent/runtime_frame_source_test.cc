#include <gtest/gtest.h>

#include <filesystem>
#include <numeric>
#include <thread>

#include "agent/runtime/frame_source.h"
#include "tests/agent/captured_log.h"
#include "tests/sensor/recording.h"
#include "tests/sensor/temporary_folder.h"

namespace pangaea {
namespace {

using testing::kRecordedFrames;
using testing::RecordedStamp;

constexpr PlayRate kMax{0.0};
// Every frame is due at once, and none is waited for.
constexpr PlayRate kAtOnce{1e12};

class FrameSourceTest : public ::testing::Test {
 protected:
  FrameSourceTest() { testing::WriteEurocRecording(folder_.path()); }

  std::filesystem::path Image(int frame) const {
    return folder_.path() / "mav0/cam0/data" / (std::to_string(RecordedStamp(frame)) + ".png");
  }
  CameraInput Open() const { return InputFrom(OpenDataset(folder_.path(), SensorKind::kStereo).value()); }

  testing::TemporaryFolder folder_;
  CapturedLog log_;
};

// A stream of small images whose stamps a test chooses; a negative stamp stands for something that is no frame.
class ScriptedStream final : public FrameStream {
 public:
  ScriptedStream(std::vector<std::int64_t> stamps, bool live) : stamps_(std::move(stamps)), live_(live) {}

  std::optional<Result<StreamFrame>> Next(const std::stop_token&) override {
    if (next_ == stamps_.size()) return std::nullopt;
    const std::int64_t stamp = stamps_[next_++];
    if (stamp < 0) return Result<StreamFrame>(Fail(ErrorCode::kCorrupt, "a truncated message"));
    return StreamFrame{stamp, [] { return Result<cv::Mat>(cv::Mat(4, 4, CV_8UC1, cv::Scalar(0))); }, {}};
  }
  bool is_live() const override { return live_; }
  std::size_t missing() const override { return 2; }

 private:
  std::vector<std::int64_t> stamps_;
  bool live_;
  std::size_t next_ = 0;
};

std::vector<int> FramesOf(FrameSource& source) {
  std::vector<int> frames;
  while (const auto frame = source.Next()) {
    frames.push_back(static_cast<int>((frame->stamp_ns - RecordedStamp(0)) / (RecordedStamp(1) - RecordedStamp(0))));
    EXPECT_EQ(frame->left.cols, testing::kRecordedWidth);
    EXPECT_TRUE(frame->right);
  }
  return frames;
}

TEST_F(FrameSourceTest, AtFullSpeedAllFramesComeInOrder) {
  const CameraInput input = Open();
  FrameSource source(*input.frames, kMax);
  EXPECT_EQ(FramesOf(source), (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(source.counters().frames, std::size_t{kRecordedFrames});
  EXPECT_EQ(source.counters().dropped, 0U);
  EXPECT_EQ(source.counters().skipped, 0U);
  EXPECT_EQ(source.stages().Statistics().at("decode").count, std::size_t{kRecordedFrames});
  EXPECT_EQ(log_.waiting(), 0U);
}

TEST_F(FrameSourceTest, ImagesThatCannotBeReadAreSkippedWithOneWarningAndACount) {
  const CameraInput input = Open();
  std::filesystem::resize_file(Image(2), std::filesystem::file_size(Image(2)) / 2);
  std::filesystem::remove(Image(4));
  testing::WriteImage(Image(5), 40, 30);
  FrameSource source(*input.frames, kMax);
  EXPECT_EQ(FramesOf(source), (std::vector<int>{0, 1, 3, 6, 7}));
  EXPECT_EQ(source.counters().skipped, 3U);
  EXPECT_EQ(source.counters().frames, std::size_t{kRecordedFrames});
  EXPECT_NE(log_.Next().find(Image(2).filename().string()), std::string::npos) << "the first is named";
  EXPECT_EQ(log_.Next(), "3 frames skipped: their images cannot be read");
  EXPECT_EQ(log_.waiting(), 0U);
}

TEST_F(FrameSourceTest, InRealTimeASlowAgentGetsTheNewestFrameAndTheOthersAreDropped) {
  const CameraInput input = Open();
  // The warning about the last image tells that all others have been played.
  std::filesystem::remove(Image(7));
  FrameSource source(*input.frames, kAtOnce);
  log_.Next();
  EXPECT_EQ(FramesOf(source), (std::vector<int>{6}));
  EXPECT_EQ(source.counters().dropped, 6U);
  EXPECT_EQ(source.counters().skipped, 1U);
}

TEST_F(FrameSourceTest, InRealTimeEveryFrameIsDeliveredDroppedOrSkipped) {
  const CameraInput input = Open();
  std::filesystem::remove(Image(3));
  FrameSource source(*input.frames, kAtOnce);
  const std::vector<int> frames = FramesOf(source);
  ASSERT_FALSE(frames.empty());
  EXPECT_TRUE(std::is_sorted(frames.begin(), frames.end()));
  EXPECT_EQ(frames.back(), 7) << "nothing is newer than the last";
  const SourceCounters counters = source.counters();
  EXPECT_EQ(frames.size() + counters.dropped + counters.skipped, counters.frames);
}

TEST_F(FrameSourceTest, FramesOutOfOrderAndWhatIsNoFrameAreSkippedAndCounted) {
  ScriptedStream stream({10, 20, 20, 15, -1, 30}, false);
  FrameSource source(stream, kMax);
  std::vector<std::int64_t> stamps;
  while (const auto frame = source.Next()) stamps.push_back(frame->stamp_ns);
  EXPECT_EQ(stamps, (std::vector<std::int64_t>{10, 20, 30}));
  EXPECT_EQ(source.counters().frames, 6U) << "of a stream without a known end";
  EXPECT_EQ(source.counters().skipped, 3U);
  EXPECT_EQ(source.counters().missing, 2U);
  EXPECT_NE(log_.Next().find("not newer"), std::string::npos);
}

TEST_F(FrameSourceTest, ALiveStreamIsNotHeldBack) {
  constexpr std::int64_t kHour_ns = 3'600'000'000'000;
  ScriptedStream stream({0, kHour_ns, 2 * kHour_ns}, true);
  FrameSource source(stream, {1.0});
  std::int64_t newest = 0;
  while (const auto frame = source.Next()) newest = frame->stamp_ns;
  EXPECT_EQ(newest, 2 * kHour_ns);
}

TEST_F(FrameSourceTest, StopEndsThePlay) {
  const CameraInput input = Open();
  // A frame an hour: only the first is due.
  FrameSource source(*input.frames, {0.05 / 3600.0});
  ASSERT_TRUE(source.Next());
  std::thread stopper([&source] { source.Stop(); });
  EXPECT_FALSE(source.Next());
  stopper.join();
  EXPECT_EQ(source.counters().dropped + source.counters().skipped, 0U);
}

TEST_F(FrameSourceTest, StopWhileFramesWaitToBeTakenEndsIt) {
  const CameraInput input = Open();
  FrameSource source(*input.frames, kMax);
  ASSERT_TRUE(source.Next());
  source.Stop();
  EXPECT_LT(FramesOf(source).size(), std::size_t{kRecordedFrames});
}

}  // namespace
}  // namespace pangaea
