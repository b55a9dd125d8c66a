#include "common/simulation/recording_writer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "common/sensor/dataset.h"

namespace pangaea {
namespace {

namespace fs = std::filesystem;

// A folder that goes away with the test.
class RecordingWriter : public testing::Test {
 protected:
  RecordingWriter()
      : folder_(fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name()) {
    fs::remove_all(folder_);
  }
  ~RecordingWriter() override { fs::remove_all(folder_); }

  static RecordingOptions Short() {
    RecordingOptions options;
    options.sessions = 2;
    options.seconds = 0.2;
    options.coarseness = 4.0;  // sooner ready
    return options;
  }

  const fs::path folder_;
};

std::map<std::string, std::string> FilesOf(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream file(entry.path(), std::ios::binary);
    files[fs::relative(entry.path(), folder).string()] = {std::istreambuf_iterator<char>(file), {}};
  }
  return files;
}

TEST_F(RecordingWriter, WritesTheSameBytesWhateverTheNumberOfThreads) {
  RecordingOptions options = Short();
  ASSERT_TRUE(WriteRecording(Recording(options), folder_ / "one", nullptr));
  options.jobs = 3;
  ASSERT_TRUE(WriteRecording(Recording(options), folder_ / "three", nullptr));
  const auto files = FilesOf(folder_ / "one");
  EXPECT_EQ(files.size(), 2U * (2U * (4U + 2U) + 1U));
  EXPECT_EQ(files, FilesOf(folder_ / "three"));
}

TEST_F(RecordingWriter, TheDatasetReaderFindsRigStampsAndTruthAsTheyWere) {
  const Recording recording(Short());
  ASSERT_TRUE(WriteRecording(recording, folder_, nullptr));
  const auto dataset = OpenDataset(folder_ / "session_2", SensorKind::kStereo);
  ASSERT_TRUE(dataset) << dataset.error().message;
  EXPECT_TRUE(dataset->warnings.empty());
  EXPECT_EQ(dataset->rig.left, recording.rig().left);
  EXPECT_EQ(dataset->rig.right, recording.rig().right);
  EXPECT_LT((dataset->rig.body_from_right.Matrix() - recording.rig().body_from_right.Matrix()).norm(), 1e-12);
  ASSERT_EQ(dataset->frames.size(), 4U);
  FramePainter painter(recording);
  for (int i = 0; i < 4; ++i) {
    const DatasetFrame& frame = dataset->frames[static_cast<std::size_t>(i)];
    EXPECT_EQ(frame.stamp_ns, recording.FrameStamp(1, i));
    const cv::Mat image = cv::imread(frame.right, cv::IMREAD_UNCHANGED);
    EXPECT_EQ(image.type(), CV_8U);
    EXPECT_EQ(cv::norm(image, painter.Paint(1, i).right, cv::NORM_INF), 0.0);
  }
  const auto truth = recording.GroundTruth(1);
  ASSERT_EQ(dataset->ground_truth.size(), truth.size());
}

TEST_F(RecordingWriter, LaterLapsShowThePicturesOfTheFirstToAndFroUnderLaterStamps) {
  RecordingOptions options = Short();
  options.laps = 3;
  const Recording recording(options);
  ASSERT_TRUE(WriteRecording(recording, folder_, nullptr));
  const auto dataset = OpenDataset(folder_ / "session_1", SensorKind::kStereo);
  ASSERT_TRUE(dataset) << dataset.error().message;
  EXPECT_TRUE(dataset->warnings.empty());
  ASSERT_EQ(dataset->frames.size(), 10U);  // 0 1 2 3 2 1 0 1 2 3
  EXPECT_EQ(dataset->frames[4].left, dataset->frames[2].left);
  EXPECT_EQ(dataset->frames[6].right, dataset->frames[0].right);
  EXPECT_EQ(dataset->frames[9].left, dataset->frames[3].left);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(dataset->frames[static_cast<std::size_t>(i)].stamp_ns, recording.FrameStamp(0, i));
  }
  const auto pose_at = [&](int frame) {
    const auto found = std::ranges::find(dataset->ground_truth, recording.FrameStamp(0, frame), &StampedPose::stamp_ns);
    return found == dataset->ground_truth.end() ? Rigid3d() : found->world_from_body;
  };
  EXPECT_LT((pose_at(4).Matrix() - pose_at(2).Matrix()).norm(), 1e-9);
  EXPECT_LT((pose_at(9).Matrix() - pose_at(3).Matrix()).norm(), 1e-9);
  EXPECT_GT((pose_at(3).translation() - pose_at(2).translation()).norm(), 1e-4);
}

TEST_F(RecordingWriter, AnUnwritableFolderIsAnErrorThatNamesIt) {
  std::ofstream(folder_) << "a file where a folder should be";
  const Status status = WriteRecording(Recording(Short()), folder_, nullptr);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kUnavailable);
  EXPECT_NE(status.error().message.find(folder_.string()), std::string::npos);
}

}  // namespace
}  // namespace pangaea
