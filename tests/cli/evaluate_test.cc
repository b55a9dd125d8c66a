#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/evaluation/trajectory_file.h"
#include "common/sensor/dataset.h"
#include "server/storage/store.h"
#include "tests/cli/command_run.h"
#include "tests/cli/recorded_store.h"
#include "tests/sensor/recording.h"
#include "tests/sensor/temporary_folder.h"

namespace pangaea {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using testing::RunPangaea;

// A hall recorded by a dataset "flight" and by a store.
class Evaluate : public ::testing::Test {
 protected:
  Evaluate() {
    testing::WriteEurocRecording(dataset());
    testing::WriteKittiRecording(Path("street"));
  }
  std::string Path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string dataset() const { return Path("flight"); }
  std::string store() const { return Path("atlas.db"); }
  // The truth of a dataset as seen in another frame.
  std::string WriteEstimate(const std::string& name, const std::string& of) const {
    const auto truth = OpenDataset(of, SensorKind::kStereo)->ground_truth;
    const Rigid3d map_from_world(Eigen::Quaterniond(0.9, 0.1, 0.3, -0.2), {1.0, 2.0, 3.0});
    std::vector<StampedPose> poses;
    for (const StampedPose& pose : truth) {
      poses.push_back({pose.stamp_ns, map_from_world * pose.world_from_body});
    }
    EXPECT_TRUE(WriteTrajectory(Path(name), poses));
    return Path(name);
  }
  static json Parse(const testing::CommandRun& run) {
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return json::parse(run.out, nullptr, false);
  }

  testing::TemporaryFolder folder_;
};

TEST_F(Evaluate, ATrajectoryIsComparedWithItsDataset) {
  const std::string file = WriteEstimate("a.tum", dataset());
  const json report = Parse(RunPangaea({"evaluate", "--trajectory", file, "--truth", dataset(), "--json"}));
  const json& session = report.at("sessions").at(0);
  EXPECT_EQ(session.at("name"), "a");
  EXPECT_EQ(session.at("frames"), testing::kRecordedFrames);
  EXPECT_DOUBLE_EQ(session.at("coverage"), 1.0);
  EXPECT_LT(session.at("ate").at("rms_m").get<double>(), 1e-6);
  EXPECT_FALSE(report.contains("joint"));
}

TEST_F(Evaluate, TrajectoriesOfOneMapShareAnAlignment) {
  const std::string first = WriteEstimate("a.tum", dataset());
  const std::string second = WriteEstimate("b.tum", Path("street"));
  const auto run = RunPangaea({"evaluate", "--trajectory", first, "--truth", dataset(), "--trajectory", second,
                               "--truth", Path("street"), "--joint"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, ::testing::ContainsRegex("jointly +16 +16 +100.0 %"));
  EXPECT_THAT(run.out, HasSubstr("SE(3)"));
}

TEST_F(Evaluate, AMissingFileOrFolderIsNamed) {
  auto run = RunPangaea({"evaluate", "--trajectory", Path("none.tum"), "--truth", dataset()});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("none.tum"));
  run = RunPangaea({"evaluate", "--store", store(), "--truth", Path("nowhere")});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("nowhere"));
  run = RunPangaea({"evaluate", "--store", store(), "--truth", dataset()});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("atlas.db"));
}

TEST_F(Evaluate, WrongOptionsAreUsageErrors) {
  const std::string file = WriteEstimate("a.tum", dataset());
  EXPECT_EQ(RunPangaea({"evaluate", "--no-such-option"}).exit_code, 2);
  EXPECT_EQ(RunPangaea({"evaluate", "--truth", dataset()}).exit_code, 2);
  EXPECT_EQ(RunPangaea({"evaluate", "--trajectory", file, "--store", "x", "--truth", dataset()}).exit_code, 2);
  const auto unpaired = RunPangaea({"evaluate", "--trajectory", file, "--trajectory", file, "--truth", dataset()});
  EXPECT_EQ(unpaired.exit_code, 2);
  EXPECT_THAT(unpaired.err, HasSubstr("each trajectory needs one truth"));
}

TEST_F(Evaluate, ATrajectoryOfAnotherTimeIsRefused) {
  const std::string file = WriteEstimate("a.tum", Path("street"));
  const auto run = RunPangaea({"evaluate", "--trajectory", file, "--truth", dataset()});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("no pose of the trajectory has ground truth at its time"));
}

TEST_F(Evaluate, ACameraNeedsADatasetThatSaysWhereItIs) {
  const std::string file = WriteEstimate("a.tum", dataset());
  EXPECT_EQ(RunPangaea({"evaluate", "--trajectory", file, "--truth", dataset(), "--camera"}).exit_code, 0);
  const auto run = RunPangaea({"evaluate", "--trajectory", file, "--truth", file, "--camera"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("--camera"));
}

TEST_F(Evaluate, SessionsOfAStoreAreMatchedByName) {
  testing::WriteStore(store(), {{.id = 1, .name = "flight"}});
  const json report = Parse(RunPangaea({"evaluate", "--store", store(), "--truth", dataset(), "--json"}));
  const json& session = report.at("sessions").at(0);
  EXPECT_EQ(session.at("name"), "flight");
  EXPECT_EQ(session.at("tracked"), testing::kRecordedFrames);
  EXPECT_EQ(session.at("keyframes"), 2);
  EXPECT_EQ(session.at("landmarks"), 6);
  EXPECT_LT(session.at("ate").at("rms_m").get<double>(), 1e-6);
  EXPECT_EQ(report.at("maps").size(), 1u);
  EXPECT_FALSE(report.at("maps").at(0).contains("joint"));
}

TEST_F(Evaluate, AStoreSaysHowLongTheServersWorkTook) {
  testing::WriteStore(store(), {{.id = 1, .name = "flight"}});
  {
    auto server = Store::Open(store(), "hall", {});
    ASSERT_TRUE(server);
    JournalBatch batch;
    for (int i = 1; i <= 20; ++i) batch.work_times.push_back({"recognition", 1.0 * i, 0.5 * i, i});
    batch.work_times.push_back({"merge", 300.0, 250.0, 30});
    ASSERT_TRUE(server->Append(batch));
  }
  const auto table = RunPangaea({"evaluate", "--store", store(), "--truth", dataset()});
  EXPECT_THAT(table.out, ::testing::ContainsRegex("recognition +20 +10.0 +19.0 +5.0 +9.5\n"));
  EXPECT_THAT(table.out, ::testing::ContainsRegex("merge +1 +300.0 +300.0 +250.0 +250.0\n"));
  EXPECT_LT(table.out.find("recognition"), table.out.find("merge"));
  const json report = Parse(RunPangaea({"evaluate", "--store", store(), "--truth", dataset(), "--json"}));
  EXPECT_EQ(report.at("work_times").at("recognition").at("count"), 20);
  EXPECT_DOUBLE_EQ(report.at("work_times").at("merge").at("cpu_median_ms").get<double>(), 250.0);
}

TEST_F(Evaluate, ASessionOfAnotherNameIsMatchedByItsTime) {
  testing::WriteStore(store(), {{.id = 1, .name = "a1"}});
  const auto run = RunPangaea({"evaluate", "--store", store(), "--truth", Path("street"), "--truth", dataset()});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, ::testing::ContainsRegex("a1 +8 +8 +100.0 % +0.0000"));
  EXPECT_THAT(run.err, HasSubstr("street: belongs to no session"));
}

TEST_F(Evaluate, WhereSeveralTruthsFitTheNameDecides) {
  testing::WriteStore(store(), {{.id = 1, .name = "a1"}});
  const std::string twin = Path("twin");
  testing::WriteEurocRecording(twin);
  const auto open = RunPangaea({"evaluate", "--store", store(), "--truth", dataset(), "--truth", twin});
  EXPECT_EQ(open.exit_code, 2);
  EXPECT_THAT(open.err, HasSubstr("--truth a1=DATASET"));
  EXPECT_EQ(RunPangaea({"evaluate", "--store", store(), "--truth", "a1=" + dataset(), "--truth", twin}).exit_code, 0);
}

TEST_F(Evaluate, ARecordingOfTheSameNameFromAnotherTimeIsRefused) {
  testing::WriteStore(store(), {{.id = 1, .name = "flight", .delay_ns = 3'600'000'000'000}});
  const auto run = RunPangaea({"evaluate", "--store", store(), "--truth", dataset()});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("session 'flight'"));
  EXPECT_THAT(run.err, HasSubstr("another recording"));
}

TEST_F(Evaluate, ASessionOfWhichNothingCameIsNoReasonToRefuse) {
  testing::WriteStore(store(), {{.id = 1, .name = "a1"}, {.id = 2, .name = "flight", .joined_only = true}});
  const auto run = RunPangaea(
      {"evaluate", "--store", store(), "--truth", "a1=" + dataset(), "--truth", "flight=" + dataset(), "--json"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(Parse(run).at("sessions").size(), 1u);
  EXPECT_THAT(run.err, HasSubstr("session 'flight': nothing of it is in the store"));
}

TEST_F(Evaluate, ATruthOfNoSessionIsRefused) {
  testing::WriteStore(store(), {{.id = 1, .name = "a1"}});
  const auto run = RunPangaea({"evaluate", "--store", store(), "--truth", Path("street")});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("none of the truths given belongs"));
}

TEST_F(Evaluate, SessionsAreJointOnlyWithinOneMap) {
  testing::WriteStore(
      store(), {{.id = 1, .name = "flight"}, {.id = 2, .name = "second", .in_map_of = 1}, {.id = 3, .name = "apart"}});
  const json report = Parse(RunPangaea({"evaluate", "--store", store(), "--truth", dataset(), "--json"}));
  ASSERT_EQ(report.at("maps").size(), 2u);
  const json& shared = report.at("maps").at(0);
  EXPECT_EQ(shared.at("sessions"), json({"flight", "second"}));
  EXPECT_EQ(shared.at("keyframes"), 4);
  EXPECT_LT(shared.at("joint").at("ate").at("rms_m").get<double>(), 1e-6);
  EXPECT_FALSE(report.at("maps").at(1).contains("joint"));
  EXPECT_EQ(report.at("sessions").size(), 3u);
}

TEST_F(Evaluate, SingleRunsStandBesideTheSharedMap) {
  testing::WriteStore(store(), {{.id = 1, .name = "flight"}, {.id = 2, .name = "second", .in_map_of = 1}});
  testing::WriteStore(Path("first.db"), {{.id = 3, .name = "flight"}});
  testing::WriteStore(Path("second.db"), {{.id = 4, .name = "second"}});
  const std::vector<std::string> arguments = {"evaluate", "--store",         store(),   "--single", Path("first.db"),
                                              "--single", Path("second.db"), "--truth", dataset()};
  const auto table = RunPangaea(arguments);
  EXPECT_EQ(table.exit_code, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("single keyframes"));
  EXPECT_THAT(table.out, HasSubstr("against the single maps: 100 % of the keyframes, 100 % of the landmarks"));
  std::vector<std::string> with_json = arguments;
  with_json.emplace_back("--json");
  const json report = Parse(RunPangaea(with_json));
  EXPECT_EQ(report.at("maps").at(0).at("single").at("keyframes"), 4);
  EXPECT_EQ(report.at("sessions").at(1).at("single").at("landmarks"), 6);
  EXPECT_LT(report.at("sessions").at(1).at("single").at("rms_m").get<double>(), 1e-6);
  std::vector<std::string> twice = arguments;
  twice.insert(twice.end(), {"--single", Path("first.db")});
  EXPECT_THAT(RunPangaea(twice).err, HasSubstr("in an earlier --single"));
}

TEST_F(Evaluate, ADatasetWithoutGroundTruthStillGivesItsCoverage) {
  std::filesystem::remove_all(folder_.path() / "flight" / "mav0" / "state_groundtruth_estimate0");
  testing::WriteStore(store(), {{.id = 1, .name = "flight"}});
  const auto run = RunPangaea({"evaluate", "--store", store(), "--truth", dataset(), "--json"});
  const json report = Parse(run);
  EXPECT_DOUBLE_EQ(report.at("sessions").at(0).at("coverage"), 1.0);
  EXPECT_FALSE(report.at("sessions").at(0).contains("ate"));
  EXPECT_THAT(run.err, HasSubstr("has no ground truth"));
}

}  // namespace
}  // namespace pangaea
