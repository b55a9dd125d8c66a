// The layouts of the TUM-VI and of the TUM RGB-D dataset.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>

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
using ::testing::SizeIs;

std::string CameraOfChain(const std::string& name, double offset) {
  return name + ":\n  camera_model: pinhole\n  distortion_model: equidistant\n" +
         "  distortion_coeffs: [0.003, 0.0007, -0.002, 0.0002]\n  intrinsics: [24, 24, 31, 24]\n" +
         "  resolution: [64, 48]\n  T_cam_imu: [[1, 0, 0, " + std::to_string(offset) +
         "], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n";
}

// An EuRoC folder made into a TUM-VI one: 16-bit images, one calibration file beside mav0, another folder for the
// truth.
class TumViDataset : public ::testing::Test {
 protected:
  TumViDataset() {
    testing::WriteEurocRecording(root_);
    const fs::path mav0 = root_ / "mav0";
    for (const char* camera : {"cam0", "cam1"}) {
      fs::remove(mav0 / camera / "sensor.yaml");
      for (const auto& image : fs::directory_iterator(mav0 / camera / "data")) {
        cv::Mat pixels(testing::kRecordedHeight, testing::kRecordedWidth, CV_16UC1, cv::Scalar(0x1280));
        EXPECT_TRUE(cv::imwrite(image.path().string(), pixels));
      }
    }
    fs::rename(mav0 / "state_groundtruth_estimate0", mav0 / "mocap0");
    fs::create_directories(root_ / "dso");
    testing::WriteText(chain_, CameraOfChain("cam0", 0.0) + CameraOfChain("cam1", -0.1));
  }

  testing::TemporaryFolder folder_;
  fs::path root_ = folder_.path() / "dataset-room1_512_16";
  fs::path chain_ = root_ / "dso" / "camchain.yaml";
};

TEST_F(TumViDataset, AWholeRecordingOpensAndItsSixteenBitImagesAreRead) {
  const auto dataset = OpenDataset(root_, SensorKind::kStereo);
  ASSERT_TRUE(dataset) << dataset.error().message;
  EXPECT_EQ(dataset->layout, "TUM-VI");
  EXPECT_EQ(dataset->name, "dataset-room1_512_16");
  EXPECT_THAT(dataset->warnings, IsEmpty());
  EXPECT_THAT(dataset->frames, SizeIs(testing::kRecordedFrames));
  EXPECT_THAT(dataset->ground_truth, SizeIs(testing::kRecordedFrames));
  EXPECT_EQ(dataset->rig.left.kind, LensKind::kEquidistant);
  const auto reader = FrameReader::Create(dataset->rig, SensorKind::kStereo);
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_NEAR(reader->rectifier().camera().baseline, 0.1, 1e-9);
  for (const DatasetFrame& frame : dataset->frames) {
    const auto image = reader->ReadRight(frame);
    ASSERT_TRUE(image) << image.error().message;
    EXPECT_EQ(image->type(), CV_8UC1);
    EXPECT_EQ(image->at<std::uint8_t>(24, 32), 0x12) << "the upper eight bits";
  }
}

TEST_F(TumViDataset, TheFolderMav0ItselfOpensToo) {
  const auto dataset = OpenDataset(root_ / "mav0", SensorKind::kMonocular);
  ASSERT_TRUE(dataset) << dataset.error().message;
  EXPECT_EQ(dataset->layout, "TUM-VI");
  EXPECT_FALSE(dataset->rig.right);
}

TEST_F(TumViDataset, ACalibrationThatIsGivenWinsOverTheFoldersOwn) {
  const fs::path other = folder_.path() / "other.yaml";
  fs::copy_file(chain_, other);
  testing::Replace(other, "intrinsics: [24,", "intrinsics: [25,");
  const auto dataset = OpenDataset(root_, SensorKind::kMonocular, other);
  ASSERT_TRUE(dataset) << dataset.error().message;
  EXPECT_EQ(dataset->rig.left.focal_x, 25.0);
}

TEST_F(TumViDataset, ASizeThatIsNotThatOfTheImagesIsAnErrorWithFileAndKey) {
  testing::Replace(chain_, "resolution: [64, 48]", "resolution: [640, 480]");
  const auto dataset = OpenDataset(root_, SensorKind::kMonocular);
  ASSERT_FALSE(dataset);
  EXPECT_THAT(dataset.error().message,
              HasSubstr(chain_.string() + ": resolution is [640, 480], but the images are 64"));
}

TEST_F(TumViDataset, WithoutACalibrationTheMissingFileIsNamed) {
  fs::remove(chain_);
  EXPECT_THAT(OpenDataset(root_, SensorKind::kMonocular).error().message, HasSubstr("sensor.yaml"));
}

class TumRgbdDataset : public ::testing::Test {
 protected:
  TumRgbdDataset() {
    fs::create_directories(root_ / "rgb");
    std::string list = "# color images\n# file: 'rgbd_dataset_freiburg2_desk.bag'\n# timestamp filename\n";
    std::string truth = "# timestamp tx ty tz qx qy qz qw\n";
    for (const char* stamp : kStamps) {
      const std::string name = std::string("rgb/") + stamp + ".png";
      cv::Mat pixels(480, 640, CV_8UC3, cv::Scalar(10, 20, 30));
      EXPECT_TRUE(cv::imwrite((root_ / name).string(), pixels));
      list += std::string(stamp) + " " + name + "\n";
      truth += std::string(stamp) + " 1 2 3 0.5 0.5 -0.5 0.5\n";
    }
    testing::WriteText(root_ / "rgb.txt", list);
    testing::WriteText(root_ / "groundtruth.txt", truth);
  }

  static constexpr const char* kStamps[] = {"1311868164.363181", "1311868164.399026", "1311868164.430940"};
  testing::TemporaryFolder folder_;
  fs::path root_ = folder_.path() / "rgbd_dataset_freiburg2_desk";
};

TEST_F(TumRgbdDataset, ColourImagesPosesAndThePublishedCalibrationAreRead) {
  const auto dataset = OpenDataset(root_, SensorKind::kMonocular);
  ASSERT_TRUE(dataset) << dataset.error().message;
  EXPECT_EQ(dataset->layout, "TUM RGB-D");
  EXPECT_THAT(dataset->warnings, IsEmpty());
  EXPECT_EQ(dataset->rig.left.focal_x, 520.9);
  EXPECT_EQ(dataset->rig.left.coefficients[4], 0.9172);
  ASSERT_THAT(dataset->frames, SizeIs(3));
  EXPECT_EQ(dataset->frames[1].stamp_ns, 1'311'868'164'399'026'000);
  ASSERT_THAT(dataset->ground_truth, SizeIs(3));
  const Rigid3d& pose = dataset->ground_truth[0].world_from_body;
  EXPECT_EQ(pose.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(pose.rotation().z(), -0.5, 1e-12);
  const auto reader = FrameReader::Create(dataset->rig, SensorKind::kMonocular);
  ASSERT_TRUE(reader) << reader.error().message;
  const auto image = reader->ReadLeft(dataset->frames[2]);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->size(), cv::Size(640, 480));
}

TEST_F(TumRgbdDataset, AnAssociationOfColourAndDepthDoesAsWell) {
  fs::remove(root_ / "rgb.txt");
  // The list may begin with either.
  testing::WriteText(root_ / "associations.txt",
                     "1311868164.363181 rgb/1311868164.363181.png 1311868164.373557 depth/1311868164.373557.png\n"
                     "1311868164.407784 depth/1311868164.407784.png 1311868164.399026 rgb/1311868164.399026.png\n"
                     "1311868164.407784 depth/1311868164.407784.png\n");
  const auto dataset = OpenDataset(root_, SensorKind::kMonocular);
  ASSERT_TRUE(dataset) << dataset.error().message;
  ASSERT_THAT(dataset->frames, SizeIs(2));
  EXPECT_EQ(dataset->frames[1].left, root_ / "rgb/1311868164.399026.png");
  EXPECT_THAT(dataset->warnings, ElementsAre(HasSubstr("1 malformed rows were skipped (the first is line 3)")));
}

TEST_F(TumRgbdDataset, AFolderOfAnUnknownCameraNeedsACalibration) {
  const fs::path renamed = folder_.path() / "desk";
  fs::rename(root_, renamed);
  EXPECT_THAT(OpenDataset(renamed, SensorKind::kMonocular).error().message,
              HasSubstr("the camera is unknown; allowed: a folder whose name contains freiburg1"));
  testing::WriteText(renamed / "calibration.yaml",
                     "cam0: {resolution: [640, 480], intrinsics: [525, 525, 319.5, 239.5], distortion_model: none}\n");
  const auto dataset = OpenDataset(renamed, SensorKind::kMonocular);
  ASSERT_TRUE(dataset) << dataset.error().message;
  EXPECT_EQ(dataset->rig.left.focal_x, 525.0);
}

TEST_F(TumRgbdDataset, StereoIsRefused) {
  EXPECT_THAT(OpenDataset(root_, SensorKind::kStereo).error().message, HasSubstr("one colour camera"));
}

TEST_F(TumRgbdDataset, RowsThatMakeNoSenseOrAreOutOfOrderAreSkippedWithOneWarningAndACountEach) {
  testing::Replace(root_ / "rgb.txt", "1311868164.399026 rgb", "later rgb");
  testing::Replace(root_ / "groundtruth.txt", "1311868164.430940 1 2 3", "1311868163.000000 1 2 3");
  testing::Replace(root_ / "groundtruth.txt", "1311868164.363181 1 2 3 0.5", "1311868164.363181 1 2 3 nan");
  const auto dataset = OpenDataset(root_, SensorKind::kMonocular);
  ASSERT_TRUE(dataset) << dataset.error().message;
  EXPECT_THAT(dataset->frames, SizeIs(2));
  EXPECT_THAT(dataset->ground_truth, SizeIs(1));
  EXPECT_THAT(dataset->warnings,
              ElementsAre(HasSubstr("rgb.txt: 1 malformed"), HasSubstr("groundtruth.txt: 1 malformed"),
                          HasSubstr("groundtruth.txt: 1 of 2 rows are out of order")));
}

TEST_F(TumRgbdDataset, AListWithoutImagesIsAnError) {
  testing::WriteText(root_ / "rgb.txt", "# nothing\n");
  EXPECT_THAT(OpenDataset(root_, SensorKind::kMonocular).error().message, HasSubstr("rgb.txt: lists no images"));
}

}  // namespace
}  // namespace pangaea
