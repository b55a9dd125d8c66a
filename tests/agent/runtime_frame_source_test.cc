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
  Dataset Open() const { return OpenDataset(folder_.path(), SensorKind::kStereo).value(); }

  testing::TemporaryFolder folder_;
  CapturedLog log_;
};

std::vector<int> FramesOf(FrameSource& source) {
  std::vector<int> frames;
  while (const auto frame = source.Next()) {
    frames.push_back(static_cast<int>((frame->stamp_ns - RecordedStamp(0)) / (RecordedStamp(1) - RecordedStamp(0))));
    EXPECT_EQ(frame->left.cols, testing::kRecordedWidth);
    EXPECT_FALSE(frame->right.empty());
  }
  return frames;
}

TEST_F(FrameSourceTest, AtFullSpeedAllFramesComeInOrder) {
  const Dataset dataset = Open();
  FrameSource source(dataset, kMax);
  EXPECT_EQ(FramesOf(source), (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(source.counters().frames, std::size_t{kRecordedFrames});
  EXPECT_EQ(source.counters().dropped, 0U);
  EXPECT_EQ(source.counters().skipped, 0U);
  EXPECT_EQ(source.stages().Statistics().at("decode").count, std::size_t{kRecordedFrames});
  EXPECT_EQ(log_.waiting(), 0U);
}

TEST_F(FrameSourceTest, ImagesThatCannotBeReadAreSkippedWithOneWarningAndACount) {
  const Dataset dataset = Open();
  std::filesystem::resize_file(Image(2), std::filesystem::file_size(Image(2)) / 2);
  std::filesystem::remove(Image(4));
  testing::WriteImage(Image(5), 40, 30);
  FrameSource source(dataset, kMax);
  EXPECT_EQ(FramesOf(source), (std::vector<int>{0, 1, 3, 6, 7}));
  EXPECT_EQ(source.counters().skipped, 3U);
  EXPECT_EQ(source.counters().frames, std::size_t{kRecordedFrames});
  EXPECT_NE(log_.Next().find(Image(2).filename().string()), std::string::npos) << "the first is named";
  EXPECT_EQ(log_.Next(), "3 frames skipped: their images cannot be read");
  EXPECT_EQ(log_.waiting(), 0U);
}

TEST_F(FrameSourceTest, InRealTimeASlowAgentGetsTheNewestFrameAndTheOthersAreDropped) {
  const Dataset dataset = Open();
  // The warning about the last image tells that all others have been played.
  std::filesystem::remove(Image(7));
  FrameSource source(dataset, kAtOnce);
  log_.Next();
  EXPECT_EQ(FramesOf(source), (std::vector<int>{6}));
  EXPECT_EQ(source.counters().dropped, 6U);
  EXPECT_EQ(source.counters().skipped, 1U);
}

TEST_F(FrameSourceTest, InRealTimeEveryFrameIsDeliveredDroppedOrSkipped) {
  const Dataset dataset = Open();
  std::filesystem::remove(Image(3));
  FrameSource source(dataset, kAtOnce);
  const std::vector<int> frames = FramesOf(source);
  ASSERT_FALSE(frames.empty());
  EXPECT_TRUE(std::is_sorted(frames.begin(), frames.end()));
  EXPECT_EQ(frames.back(), 7) << "nothing is newer than the last";
  const SourceCounters counters = source.counters();
  EXPECT_EQ(frames.size() + counters.dropped + counters.skipped, counters.frames);
}

TEST_F(FrameSourceTest, StopEndsThePlay) {
  const Dataset dataset = Open();
  // A frame an hour: only the first is due.
  FrameSource source(dataset, {0.05 / 3600.0});
  ASSERT_TRUE(source.Next());
  std::thread stopper([&source] { source.Stop(); });
  EXPECT_FALSE(source.Next());
  stopper.join();
  EXPECT_EQ(source.counters().dropped + source.counters().skipped, 0U);
}

TEST_F(FrameSourceTest, StopWhileFramesWaitToBeTakenEndsIt) {
  const Dataset dataset = Open();
  FrameSource source(dataset, kMax);
  ASSERT_TRUE(source.Next());
  source.Stop();
  EXPECT_LT(FramesOf(source).size(), std::size_t{kRecordedFrames});
}

}  // namespace
}  // namespace pangaea
