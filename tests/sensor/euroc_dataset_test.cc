#include "common/sensor/euroc_dataset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/text.h"
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
using testing::RecordedStamp;

class EurocDataset : public ::testing::Test {
 protected:
  void SetUp() override { testing::WriteEurocRecording(root_); }

  Dataset Open(SensorKind kind = SensorKind::kStereo) {
    auto dataset = OpenDataset(root_, kind);
    EXPECT_TRUE(dataset) << dataset.error().message;
    return dataset ? std::move(*dataset) : Dataset{};
  }
  std::string OpeningFails() {
    const auto dataset = OpenDataset(root_, SensorKind::kStereo);
    return dataset ? "opened" : dataset.error().message;
  }
  // How many frames can be read whole, left and right; the errors of the others.
  int ReadAll(const Dataset& dataset, std::vector<std::string>* errors) {
    const auto reader = FrameReader::Create(dataset.rig, SensorKind::kStereo);
    EXPECT_TRUE(reader) << reader.error().message;
    int whole = 0;
    for (const DatasetFrame& frame : dataset.frames) {
      const auto left = reader->ReadLeft(frame);
      const auto right = reader->ReadRight(frame);
      if (!left) errors->push_back(left.error().message);
      if (!right) errors->push_back(right.error().message);
      whole += left && right ? 1 : 0;
    }
    return whole;
  }
  fs::path ImageOf(int camera, int frame) const {
    return root_ / "mav0" / ("cam" + std::to_string(camera)) / "data" / (std::to_string(RecordedStamp(frame)) + ".png");
  }

  testing::TemporaryFolder folder_;
  fs::path root_ = folder_.path() / "hall_01";
  fs::path cam0_ = root_ / "mav0" / "cam0";
  fs::path cam1_ = root_ / "mav0" / "cam1";
  fs::path truth_ = root_ / "mav0" / "state_groundtruth_estimate0" / "data.csv";
};

TEST_F(EurocDataset, TheGroundTruthIsLeftAloneWhereNobodyAsksForIt) {
  testing::WriteText(truth_, "it would make a warning");
  const auto dataset = OpenDataset(root_, SensorKind::kStereo, {}, GroundTruth::kLeave);
  ASSERT_TRUE(dataset) << dataset.error().message;
  EXPECT_THAT(dataset->ground_truth, IsEmpty());
  EXPECT_THAT(dataset->warnings, IsEmpty());
  EXPECT_EQ(dataset->frames.size(), std::size_t{kRecordedFrames});
}

TEST_F(EurocDataset, AWholeRecordingOpensWithoutWarnings) {
  const Dataset dataset = Open();
  EXPECT_EQ(dataset.name, "hall_01");
  EXPECT_EQ(dataset.layout, "EuRoC");
  EXPECT_THAT(dataset.warnings, IsEmpty());
  ASSERT_EQ(dataset.frames.size(), std::size_t{kRecordedFrames});
  EXPECT_EQ(dataset.frames[3].stamp_ns, RecordedStamp(3));
  EXPECT_EQ(dataset.frames[3].right, ImageOf(1, 3));
  EXPECT_EQ(dataset.rig.left.focal_y, 60.5);
  EXPECT_EQ(dataset.rig.right->coefficients[3], 0.0002);
  EXPECT_EQ(dataset.rig.body_from_right.translation().x(), 0.11);
  ASSERT_EQ(dataset.ground_truth.size(), std::size_t{kRecordedFrames});
  EXPECT_NEAR(dataset.ground_truth[2].world_from_body.translation().x(), 0.2, 1e-9);
  EXPECT_NEAR(dataset.ground_truth[2].world_from_body.rotation().x(), 0.5, 1e-9);
  std::vector<std::string> errors;
  EXPECT_EQ(ReadAll(dataset, &errors), kRecordedFrames);
}

TEST_F(EurocDataset, TheFolderMav0ItselfAndATrailingSlashOpenToo) {
  for (const fs::path& path : {root_ / "mav0", root_ / "", root_ / "mav0" / ""}) {
    const auto dataset = OpenDataset(path, SensorKind::kStereo);
    ASSERT_TRUE(dataset) << dataset.error().message;
    EXPECT_EQ(dataset->name, "hall_01") << path;
  }
}

TEST_F(EurocDataset, AMonocularSensorNeedsNoSecondCamera) {
  fs::remove_all(cam1_);
  const Dataset dataset = Open(SensorKind::kMonocular);
  EXPECT_EQ(dataset.frames.size(), std::size_t{kRecordedFrames});
  EXPECT_TRUE(dataset.frames[0].right.empty());
  EXPECT_THAT(OpeningFails(), HasSubstr("cam1"));
}

TEST_F(EurocDataset, ATruncatedPngCostsItsFrameAlone) {
  fs::resize_file(ImageOf(0, 2), fs::file_size(ImageOf(0, 2)) / 2);
  std::vector<std::string> errors;
  EXPECT_EQ(ReadAll(Open(), &errors), kRecordedFrames - 1);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_THAT(errors[0], HasSubstr(ImageOf(0, 2).string() + ": truncated"));
}

TEST_F(EurocDataset, AMissingImageCostsItsFrameAlone) {
  fs::remove(ImageOf(1, 5));
  std::vector<std::string> errors;
  EXPECT_EQ(ReadAll(Open(), &errors), kRecordedFrames - 1);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_THAT(errors[0], HasSubstr(ImageOf(1, 5).string() + ": there is no such file"));
}

TEST_F(EurocDataset, SwappedImageSizesOfOneImageCostItsFrameAlone) {
  testing::WriteImage(ImageOf(0, 4), testing::kRecordedHeight, testing::kRecordedWidth);
  std::vector<std::string> errors;
  EXPECT_EQ(ReadAll(Open(), &errors), kRecordedFrames - 1);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_THAT(errors[0], HasSubstr("48 x 64 pixels, the calibration says 64 x 48"));
}

TEST_F(EurocDataset, SwappedImageSizesInTheCalibrationAreAnErrorWithFileAndKey) {
  testing::Replace(cam0_ / "sensor.yaml", "resolution: [64, 48]", "resolution: [48, 64]");
  const std::string message = OpeningFails();
  EXPECT_THAT(message, HasSubstr("cam0/sensor.yaml: resolution is [48, 64]"));
  EXPECT_THAT(message, HasSubstr("64 x 48"));
}

TEST_F(EurocDataset, RowsOfDataCsvOutOfOrderAreSkippedWithOneWarningAndACount) {
  const auto row = [](int i) {
    return std::to_string(RecordedStamp(i)) + "," + std::to_string(RecordedStamp(i)) + ".png\n";
  };
  // 5 comes too early and 1 twice.
  testing::WriteText(cam0_ / "data.csv",
                     row(0) + row(5) + row(1) + row(1) + row(2) + row(3) + row(4) + row(6) + row(7));
  const Dataset dataset = Open(SensorKind::kMonocular);
  std::vector<std::int64_t> stamps;
  for (const DatasetFrame& frame : dataset.frames) stamps.push_back(frame.stamp_ns - RecordedStamp(0));
  constexpr std::int64_t kStep = 50'000'000;
  EXPECT_THAT(stamps, ElementsAre(0, kStep, 2 * kStep, 3 * kStep, 4 * kStep, 6 * kStep, 7 * kStep));
  ASSERT_EQ(dataset.warnings.size(), 1U);
  EXPECT_THAT(dataset.warnings[0], HasSubstr("data.csv: 2 of 9 rows are out of order"));
}

TEST_F(EurocDataset, DataCsvMayHaveCommentsBlankLinesForeignLineEndingsAndNoLastOne) {
  std::string text = "#timestamp [ns],filename\r\n\r\n# a remark\r\n";
  for (int i = 0; i < kRecordedFrames; ++i) {
    const std::string stamp = std::to_string(RecordedStamp(i));
    text += (i > 0 ? "\r\n" : "") + stamp + " , " + stamp + ".png";
  }
  testing::WriteText(cam0_ / "data.csv", text);
  const Dataset dataset = Open();
  EXPECT_THAT(dataset.warnings, IsEmpty());
  ASSERT_EQ(dataset.frames.size(), std::size_t{kRecordedFrames});
  EXPECT_TRUE(fs::exists(dataset.frames.back().left));
}

TEST_F(EurocDataset, MalformedRowsAreCountedWithTheFirstLine) {
  const std::string row = std::to_string(RecordedStamp(0));
  testing::WriteText(cam0_ / "data.csv", "nonsense\n" + row + "," + row + ".png\n12x,a.png\n99\n-5,b.png\n");
  const Dataset dataset = Open(SensorKind::kMonocular);
  EXPECT_EQ(dataset.frames.size(), 1U);
  EXPECT_THAT(dataset.warnings, ElementsAre(HasSubstr("4 malformed rows were skipped (the first is line 1)")));
}

TEST_F(EurocDataset, AnEmptyDataCsvIsAnError) {
  testing::WriteText(cam0_ / "data.csv", "#timestamp [ns],filename\n");
  EXPECT_THAT(OpeningFails(), HasSubstr("data.csv: lists no images"));
}

TEST_F(EurocDataset, ImagesPairWhereTheirStampsAreNearAndTheOthersAreCounted) {
  std::string right;
  for (int i = 1; i < kRecordedFrames; ++i) {
    const std::string file = std::to_string(RecordedStamp(i)) + ".png\n";
    right += std::to_string(RecordedStamp(i) + (i == 3 ? 20'000'000 : 900'000)) + "," + file;
  }
  testing::WriteText(cam1_ / "data.csv", right);
  const Dataset dataset = Open();
  ASSERT_EQ(dataset.frames.size(), std::size_t{kRecordedFrames - 2});
  EXPECT_EQ(dataset.frames[0].left, ImageOf(0, 1));
  EXPECT_EQ(dataset.frames[0].right, ImageOf(1, 1));
  EXPECT_EQ(dataset.frames[2].right, ImageOf(1, 4));
  EXPECT_THAT(dataset.warnings, ElementsAre(HasSubstr("3 images have no partner")));
}

TEST_F(EurocDataset, AMissingCalibrationKeyIsAnErrorWithFileKeyAndWhatIsAllowed) {
  for (const std::string key : {"intrinsics", "resolution", "distortion_model", "distortion_coefficients", "data"}) {
    const std::string original = *ReadTextFile(cam1_ / "sensor.yaml");
    testing::Replace(cam1_ / "sensor.yaml", key + ":", "other_" + key + ":");
    const std::string message = OpeningFails();
    EXPECT_THAT(message, HasSubstr("cam1/sensor.yaml: the key ")) << key;
    EXPECT_THAT(message, HasSubstr(key + " is missing; allowed: ")) << key;
    testing::WriteText(cam1_ / "sensor.yaml", original);
  }
}

TEST_F(EurocDataset, ImpossibleCalibrationValuesAreErrorsWithFileLineAndKey) {
  struct Case {
    std::string from, to, message;
  };
  for (const Case& wrong :
       {Case{"intrinsics: [60.0", "intrinsics: [-60.0", "cam0/sensor.yaml:16: intrinsics: number 1 is '-60.0'"},
        Case{"intrinsics: [60.0", "intrinsics: [nan", "cam0/sensor.yaml:16: intrinsics: number 1 is 'nan'"},
        Case{"31.0, 24.0]", "31.0]", "cam0/sensor.yaml:16: intrinsics has 3 numbers; allowed: 4 numbers"},
        Case{"[64, 48]", "[64, 0]", "cam0/sensor.yaml:14: resolution: number 2 is '0'"},
        Case{"radial-tangential", "spherical", "cam0/sensor.yaml:17: distortion_model is 'spherical'"},
        Case{"0.0001, 0.0002]", "0.0001]", "distortion_coefficients has 3 numbers; allowed: 4 or 5 numbers"},
        Case{"camera_model: pinhole", "camera_model: omni", "cam0/sensor.yaml:15: camera_model is 'omni'"},
        Case{"data: [1.0", "data: [2.0", "T_BS.data is not a rigid motion"},
        Case{"T_BS:", "T_BS: [", "not valid YAML"}}) {
    const std::string original = *ReadTextFile(cam0_ / "sensor.yaml");
    testing::Replace(cam0_ / "sensor.yaml", wrong.from, wrong.to);
    EXPECT_THAT(OpeningFails(), HasSubstr(wrong.message)) << wrong.to;
    testing::WriteText(cam0_ / "sensor.yaml", original);
  }
}

TEST_F(EurocDataset, AnEquidistantLensHasFourCoefficients) {
  testing::Replace(cam0_ / "sensor.yaml", "radial-tangential", "equidistant");
  EXPECT_EQ(Open().rig.left.kind, LensKind::kEquidistant);
}

TEST_F(EurocDataset, MalformedGroundTruthIsCountedAndMissingTruthIsFine) {
  testing::Replace(truth_, ",2,3,0.5", ",2,nan,0.5");
  testing::Replace(truth_, "0.100000,2,3,0.5,0.5,0.5,0.5", "0.1,2,3,0,0,0,0");
  const Dataset dataset = Open();
  EXPECT_EQ(dataset.ground_truth.size(), std::size_t{kRecordedFrames - 2});
  EXPECT_THAT(dataset.warnings, ElementsAre(HasSubstr("2 malformed rows")));
  fs::remove(truth_);
  EXPECT_THAT(Open().ground_truth, IsEmpty());
}

TEST_F(EurocDataset, AFolderOfNoKnownLayoutIsAnErrorThatNamesTheKnownOnes) {
  const auto unknown = OpenDataset(folder_.path(), SensorKind::kStereo);
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().message, HasSubstr("EuRoC"));
  EXPECT_THAT(unknown.error().message, HasSubstr("KITTI"));
  const auto missing = OpenDataset(folder_.path() / "none", SensorKind::kStereo);
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("no such folder"));
}

}  // namespace
}  // namespace pangaea
