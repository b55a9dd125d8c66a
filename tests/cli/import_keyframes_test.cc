#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "common/evaluation/trajectory_file.h"
#include "common/map/consistency.h"
#include "common/sensor/dataset.h"
#include "common/simulation/recording_writer.h"
#include "server/storage/recovery.h"
#include "tests/cli/command_run.h"
#include "tests/sensor/recording.h"
#include "tests/sensor/temporary_folder.h"

namespace pangaea {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;
using testing::RunPangaea;

// Real recordings lie outside of the repository.
fs::path RealKeyframes() {
  const char* shared = std::getenv("PANGAEA_SHARED");
  return fs::path(shared != nullptr ? shared : PANGAEA_SOURCE_DIR "/../shared") / "data" / "euroc_V1_01_keyframes";
}

RecoveredAtlas Recover(const std::string& path) {
  auto store = Store::OpenReadOnly(path);
  EXPECT_TRUE(store);
  auto recovered = RecoverAtlas(*store);
  EXPECT_TRUE(recovered);
  return std::move(*recovered);
}

// Six seconds of a simulated flight at 4 Hz, and an empty place for a store.
class ImportKeyframes : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    RecordingOptions options;
    options.sessions = 1;
    options.seconds = 6.0;
    options.rate = 4.0;
    options.coarseness = 3.0;
    options.jobs = 2;
    ASSERT_TRUE(WriteRecording(Recording(options), recordings_.path(), nullptr));
  }
  static std::string flight() { return (recordings_.path() / "session_1").string(); }
  std::string Path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string store() const { return Path("atlas.db"); }
  // A copy of the flight, to spoil.
  std::string Copy() const {
    fs::copy(flight(), Path("copy"), fs::copy_options::recursive);
    return Path("copy");
  }
  // That the command fails with these words and leaves no session behind.
  void ExpectError(const std::vector<std::string>& arguments, int exit_code, const std::string& words) const {
    std::vector<std::string> all{"import-keyframes"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    all.insert(all.end(), {"--store", store()});
    const auto run = RunPangaea(all);
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    EXPECT_THAT(run.err, HasSubstr(words));
    if (!fs::exists(store())) return;
    EXPECT_TRUE(Recover(store()).sessions.empty());
  }

  static inline testing::TemporaryFolder recordings_;
  testing::TemporaryFolder folder_;
};

TEST_F(ImportKeyframes, ASimulatedFlightBecomesASessionWhereTheTruthIs) {
  const auto run = RunPangaea({"import-keyframes", flight(), "--store", store(), "--name", "survey"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("24 keyframes"));
  const RecoveredAtlas recovered = Recover(store());
  EXPECT_THAT(CheckConsistency(recovered.atlas), ::testing::IsEmpty());
  EXPECT_EQ(recovered.atlas.keyframe_count(), 24U);
  ASSERT_EQ(recovered.sessions.size(), 1U);
  EXPECT_EQ(recovered.sessions[0].announcement.name, "survey");
  EXPECT_EQ(recovered.sessions[0].announcement.sensor_kind, SensorKind::kStereo);
  EXPECT_TRUE(recovered.sessions[0].announcement.closed);
  const auto evaluation = RunPangaea({"evaluate", "--store", store(), "--truth", "survey=" + flight(), "--json"});
  ASSERT_EQ(evaluation.exit_code, 0) << evaluation.err;
  EXPECT_LT(json::parse(evaluation.out).at("sessions").at(0).at("ate").at("rms_m").get<double>(), 1e-6);
}

TEST_F(ImportKeyframes, OneCameraIsEnough) {
  const auto run = RunPangaea({"import-keyframes", flight(), "--store", store(), "--sensor", "mono"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const RecoveredAtlas recovered = Recover(store());
  EXPECT_EQ(recovered.sessions.at(0).announcement.sensor_kind, SensorKind::kMonocular);
  EXPECT_GT(recovered.atlas.landmark_count(), 500U);
  recovered.atlas.ForEachLandmark([](const Landmark& landmark) { EXPECT_GE(landmark.observations.size(), 2U); });
}

TEST_F(ImportKeyframes, AnIntervalThinsThemOut) {
  ASSERT_EQ(RunPangaea({"import-keyframes", flight(), "--store", store(), "--interval", "1"}).exit_code, 0);
  EXPECT_EQ(Recover(store()).atlas.keyframe_count(), 6U);
}

TEST_F(ImportKeyframes, ASecondImportIsAnotherSessionOfTheStoresSite) {
  ASSERT_EQ(RunPangaea({"import-keyframes", flight(), "--store", store(), "--site", "hall"}).exit_code, 0);
  ASSERT_EQ(RunPangaea({"import-keyframes", flight(), "--store", store(), "--name", "again"}).exit_code, 0);
  const RecoveredAtlas recovered = Recover(store());
  EXPECT_EQ(recovered.sessions.size(), 2U);
  EXPECT_EQ(recovered.atlas.Maps().size(), 2U);
  EXPECT_EQ(recovered.sessions[1].announcement.site, "hall");
  const auto run = RunPangaea({"import-keyframes", flight(), "--store", store(), "--site", "elsewhere"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("holds the atlas of site 'hall'"));
}

TEST_F(ImportKeyframes, PosesMayComeFromAFile) {
  const auto truth = OpenDataset(flight(), SensorKind::kStereo)->ground_truth;
  ASSERT_TRUE(WriteTrajectory(Path("poses.tum"), truth));
  const std::string copy = Copy();
  fs::remove_all(fs::path(copy) / "mav0" / "state_groundtruth_estimate0");
  ExpectError({copy}, 1, "has no poses; give them with --poses");
  const auto run = RunPangaea({"import-keyframes", copy, "--store", store(), "--poses", Path("poses.tum")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

TEST_F(ImportKeyframes, WhatIsNotThereIsNamed) {
  ExpectError({Path("nowhere")}, 1, "nowhere");
  ExpectError({flight(), "--poses", Path("none.tum")}, 1, "none.tum");
}

TEST_F(ImportKeyframes, PosesOfAnotherTimeAreRefused) {
  auto poses = OpenDataset(flight(), SensorKind::kStereo)->ground_truth;
  for (StampedPose& pose : poses) pose.stamp_ns += 3'600'000'000'000;
  ASSERT_TRUE(WriteTrajectory(Path("late.tum"), poses));
  ExpectError({flight(), "--poses", Path("late.tum")}, 2, "24 frames without a pose at their time");
}

TEST_F(ImportKeyframes, PosesThatDoNotFitTheImagesAreRefused) {
  auto poses = OpenDataset(flight(), SensorKind::kStereo)->ground_truth;
  std::vector<StampedPose> reversed = poses;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    // Elsewhere, and looking elsewhere.
    const Rigid3d turn(
        Eigen::Quaterniond(Eigen::AngleAxisd(0.7 * static_cast<double>(i % 9), Eigen::Vector3d::UnitZ())),
        {0.5 * static_cast<double>(i % 7), 0.0, 0.0});
    reversed[i].world_from_body = poses[poses.size() - 1 - i].world_from_body * turn;
  }
  ASSERT_TRUE(WriteTrajectory(Path("wrong.tum"), reversed));
  ExpectError({flight(), "--poses", Path("wrong.tum")}, 1, "are poses, calibration and images of one recording?");
}

TEST_F(ImportKeyframes, OneKeyframeIsNoMap) {
  ExpectError({flight(), "--interval", "100"}, 2, "a map needs two keyframes with poses, there is one");
}

TEST_F(ImportKeyframes, BadIntervalsAndSensorsAreUsageErrors) {
  ExpectError({flight(), "--interval", "-1"}, 2, "--interval");
  ExpectError({flight(), "--sensor", "lidar"}, 2, "lidar");
  const std::string copy = Copy();
  fs::remove_all(fs::path(copy) / "mav0" / "cam1");
  ExpectError({copy, "--sensor", "stereo"}, 1, "cam1");
}

TEST_F(ImportKeyframes, AnUnreadableImageCostsItsKeyframeAlone) {
  const std::string copy = Copy();
  const auto frames = OpenDataset(copy, SensorKind::kStereo)->frames;
  fs::resize_file(frames.at(3).left, 100);
  fs::resize_file(frames.at(5).right, 100);
  const auto run = RunPangaea({"import-keyframes", copy, "--store", store()});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("23 keyframes"));
  EXPECT_THAT(run.err, HasSubstr("1 frames were skipped"));
  EXPECT_THAT(run.err, HasSubstr("1 frames have no depth"));
}

TEST_F(ImportKeyframes, AStoreInUseIsRefused) {
  const auto server = Store::Open(store(), "default", {});
  ASSERT_TRUE(server);
  ExpectError({flight()}, 1, "in use by another process");
}

TEST_F(ImportKeyframes, RealKeyframesAreImportedWhereTheyAre) {
  const fs::path real = RealKeyframes();
  if (!fs::exists(real)) GTEST_SKIP() << real << " is not here; set PANGAEA_SHARED";
  const auto run = RunPangaea({"import-keyframes", real.string(), "--store", store()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const RecoveredAtlas recovered = Recover(store());
  EXPECT_EQ(recovered.atlas.keyframe_count(), 100U);
  std::size_t shared = 0;
  recovered.atlas.ForEachLandmark(
      [&shared](const Landmark& landmark) { shared += landmark.observations.size() > 1 ? 1 : 0; });
  EXPECT_GT(shared, 8000U);
}

}  // namespace
}  // namespace pangaea
