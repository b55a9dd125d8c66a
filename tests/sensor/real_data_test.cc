#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "common/sensor/dataset.h"
#include "common/sensor/frame_reader.h"

namespace pangaea {
namespace {

// Real recordings lie outside of the repository.
std::filesystem::path SharedData() {
  const char* shared = std::getenv("PANGAEA_SHARED");
  return std::filesystem::path(shared != nullptr ? shared : PANGAEA_SOURCE_DIR "/../shared") / "data";
}

class RealData : public ::testing::TestWithParam<const char*> {};

TEST_P(RealData, EveryImageIsReadAndRectified) {
  const std::filesystem::path folder = SharedData() / GetParam();
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here; set PANGAEA_SHARED";
  const auto dataset = OpenDataset(folder, SensorKind::kStereo);
  ASSERT_TRUE(dataset) << dataset.error().message;
  EXPECT_TRUE(dataset->warnings.empty()) << dataset->warnings.front();
  EXPECT_GE(dataset->ground_truth.size(), dataset->frames.size());
  const auto reader = FrameReader::Create(dataset->rig, SensorKind::kStereo);
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_GT(reader->rectifier().camera().baseline, 0.1);
  for (const DatasetFrame& frame : dataset->frames) {
    const auto left = reader->ReadLeft(frame);
    const auto right = reader->ReadRight(frame);
    EXPECT_TRUE(left) << left.error().message;
    EXPECT_TRUE(right) << right.error().message;
  }
}

INSTANTIATE_TEST_SUITE_P(Recordings, RealData,
                         ::testing::Values("euroc_V1_01_takeoff", "kitti_odometry_a", "kitti_odometry_b"));

}  // namespace
}  // namespace pangaea
