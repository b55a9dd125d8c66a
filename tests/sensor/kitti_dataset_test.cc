#include "common/sensor/kitti_dataset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/sensor/dataset.h"
#include "common/sensor/frame_reader.h"
#include "tests/sensor/recording.h"
#include "tests/sensor/temporary_folder.h"

namespace pangaea {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kRecordedFrames;

class KittiDataset : public ::testing::Test {
 protected:
  void SetUp() override { testing::WriteKittiRecording(root_); }

  std::string OpeningFails() {
    const auto dataset = OpenDataset(root_, SensorKind::kStereo);
    return dataset ? "opened" : dataset.error().message;
  }

  testing::TemporaryFolder folder_;
  fs::path root_ = folder_.path() / "drive";
};

TEST_F(KittiDataset, AWholeRecordingOpensRectifiedAndWithTheLeftCameraAsBody) {
  const auto dataset = OpenDataset(root_, SensorKind::kStereo);
  ASSERT_TRUE(dataset) << dataset.error().message;
  EXPECT_EQ(dataset->layout, "KITTI");
  EXPECT_THAT(dataset->warnings, IsEmpty());
  ASSERT_EQ(dataset->frames.size(), std::size_t{kRecordedFrames});
  EXPECT_EQ(dataset->frames[3].stamp_ns, 300'000'000);
  ASSERT_EQ(dataset->ground_truth.size(), std::size_t{kRecordedFrames});
  EXPECT_NEAR(dataset->ground_truth[3].world_from_body.translation().z(), 0.3, 1e-9);
  const auto reader = FrameReader::Create(dataset->rig, SensorKind::kStereo);
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_EQ(reader->rectifier().camera(), (IdealCamera{64, 48, 60, 60, 31, 24, 0.5}));
  EXPECT_TRUE(reader->ReadLeft(dataset->frames[0]));
  EXPECT_TRUE(reader->ReadRight(dataset->frames[0]));
}

TEST_F(KittiDataset, AMissingCalibrationKeyIsAnErrorWithFileKeyAndWhatIsAllowed) {
  testing::Replace(root_ / "calib.txt", "P1:", "P9:");
  EXPECT_THAT(OpeningFails(), HasSubstr("calib.txt: the key P1: is missing; allowed: "));
  fs::remove(root_ / "calib.txt");
  EXPECT_THAT(OpeningFails(), HasSubstr("calib.txt: there is no such file"));
}

TEST_F(KittiDataset, AnImpossibleCalibrationIsAnErrorWithItsLine) {
  testing::Replace(root_ / "calib.txt", "P1: 60", "P1: nan");
  EXPECT_THAT(OpeningFails(), HasSubstr("calib.txt:2: P1: is not a projection matrix"));
  testing::Replace(root_ / "calib.txt", "P1: nan 0 31 -30", "P1: 60 0 31 30");
  EXPECT_THAT(OpeningFails(), HasSubstr("not a rectified pair"));
}

TEST_F(KittiDataset, TimesOutOfOrderAreSkippedWithOneWarningAndACountAndPosesStayMatched) {
  testing::WriteText(root_ / "times.txt", "0\n1e-1\n9e-1\n3e-1\nx\n5e-1\n6e-1\n7e-1\n");
  const auto dataset = OpenDataset(root_, SensorKind::kStereo);
  ASSERT_TRUE(dataset) << dataset.error().message;
  EXPECT_THAT(dataset->warnings, ElementsAre(HasSubstr("1 malformed"), HasSubstr("1 of 7 rows are out of order")));
  ASSERT_EQ(dataset->frames.size(), 6U);
  EXPECT_THAT(dataset->frames[3].left, HasSubstr("000005.png"));
  EXPECT_NEAR(dataset->ground_truth[3].world_from_body.translation().z(), 0.5, 1e-9);
}

TEST_F(KittiDataset, AMissingFirstImageLeavesTheSizeToTheNext) {
  fs::remove(root_ / "image_0" / "000000.png");
  const auto dataset = OpenDataset(root_, SensorKind::kStereo);
  ASSERT_TRUE(dataset) << dataset.error().message;
  EXPECT_EQ(dataset->rig.left.width, 64);
  for (int i = 1; i < kRecordedFrames; ++i) fs::remove(dataset->frames[static_cast<std::size_t>(i)].left);
  EXPECT_THAT(OpeningFails(), HasSubstr("000000.png: there is no such file"));
}

TEST_F(KittiDataset, SwappedImageSizesOfTheFirstImageDoNotDecideForAll) {
  testing::WriteImage(root_ / "image_0" / "000000.png", testing::kRecordedHeight, testing::kRecordedWidth);
  const auto dataset = OpenDataset(root_, SensorKind::kStereo);
  ASSERT_TRUE(dataset) << dataset.error().message;
  EXPECT_EQ(dataset->rig.left.width, testing::kRecordedWidth);
}

TEST_F(KittiDataset, MissingPosesAreFine) {
  fs::remove(root_ / "poses.txt");
  const auto dataset = OpenDataset(root_, SensorKind::kStereo);
  ASSERT_TRUE(dataset) << dataset.error().message;
  EXPECT_THAT(dataset->ground_truth, IsEmpty());
}

}  // namespace
}  // namespace pangaea
