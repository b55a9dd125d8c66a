#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "agent/runtime/agent_output.h"
#include "common/evaluation/trajectory_file.h"
#include "common/map/map_edit.h"
#include "tests/sensor/temporary_folder.h"

namespace pangaea {
namespace {

constexpr SessionId kSession = 7;
constexpr std::int64_t kSecond = 1'000'000'000;

// Two maps: one keyframe in the first, three in the second, each half a second and a metre from the one before.
AgentRun RunWithTwoMaps() {
  Atlas atlas;
  std::int64_t stamp_ns = 1403715273262142976;
  std::uint32_t counter = 0;
  const auto add = [&](std::uint32_t map, bool root) {
    auto data = std::make_shared<KeyframeData>();
    data->stamp_ns = stamp_ns += kSecond / 2;
    data->camera = {640, 480, 400.0, 400.0, 320.0, 240.0, 0.1};
    const KeyframeId parent = root ? KeyframeId{} : KeyframeId{kSession, counter};
    ++counter;
    EXPECT_TRUE(Apply(
        AddKeyframe{{kSession, counter}, {kSession, map}, parent, Rigid3d({1, 0, 0, 0}, {-1, 0, 0}), data}, atlas));
  };
  add(1, true);
  add(2, true);
  add(2, false);
  add(2, false);
  AgentRun run;
  run.session = kSession;
  run.name = "a1";
  run.source = {10, 2, 1};
  run.flight.tracked = 6;
  run.flight.lost = 1;
  run.atlas = std::make_shared<const Atlas>(std::move(atlas));
  // The camera sits 1 m ahead of the body.
  run.body_from_camera = Rigid3d({1, 0, 0, 0}, {1, 0, 0});
  run.flight.live_trajectory = {{stamp_ns, Rigid3d()}};
  run.stages["tracking"] = {7, 1.0, 2.0, 3.0};
  return run;
}

class AgentOutput : public ::testing::Test {
 protected:
  std::filesystem::path Path(const std::string& name) const { return folder_.path() / name; }
  std::vector<StampedPose> Read(const std::string& name) const {
    const auto poses = ReadTrajectory(Path(name));
    EXPECT_TRUE(poses) << poses.error().message;
    return poses.value_or(std::vector<StampedPose>());
  }

  testing::TemporaryFolder folder_;
};

TEST_F(AgentOutput, EachMapHasATrajectoryOfItsOwnTheLargestFirst) {
  AgentOptions options;
  options.trajectory = Path("out.tum");
  ASSERT_TRUE(WriteOutputs(options, RunWithTwoMaps()));
  EXPECT_EQ(Read("out.tum").size(), 3U);
  EXPECT_EQ(Read("out.2.tum").size(), 1U);
  EXPECT_FALSE(std::filesystem::exists(Path("out.3.tum")));
}

TEST_F(AgentOutput, TheTrajectoryIsThatOfTheBodyWithExactStamps) {
  AgentOptions options;
  options.trajectory = Path("out.tum");
  ASSERT_TRUE(WriteOutputs(options, RunWithTwoMaps()));
  const auto poses = Read("out.tum");
  ASSERT_EQ(poses.size(), 3U);
  EXPECT_EQ(poses[0].stamp_ns, 1403715273262142976 + kSecond);
  // The cameras are at 1, 2 and 3 m; the body is 1 m behind.
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_NEAR(poses[i].world_from_body.translation().x(), static_cast<double>(i), 1e-9);
  }
}

TEST_F(AgentOutput, TheLiveTrajectoryAndTheReportAreWrittenWhereAsked) {
  AgentOptions options;
  options.live_trajectory = Path("live.tum");
  options.report = Path("report.json");
  ASSERT_TRUE(WriteOutputs(options, RunWithTwoMaps()));
  EXPECT_EQ(Read("live.tum").size(), 1U);
  std::ifstream file(Path("report.json"));
  EXPECT_EQ(nlohmann::json::parse(file), ReportOf(RunWithTwoMaps()));
}

TEST_F(AgentOutput, AFileThatCannotBeWrittenIsAnErrorThatNamesIt) {
  AgentOptions options;
  options.report = Path("no/such/report.json");
  const Status status = WriteOutputs(options, RunWithTwoMaps());
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("report.json"), std::string::npos);
}

TEST_F(AgentOutput, TheReportHasWhatTheIssueLists) {
  const nlohmann::json report = ReportOf(RunWithTwoMaps());
  EXPECT_EQ(report.at("frames"), 10);
  EXPECT_EQ(report.at("tracked"), 6);
  EXPECT_EQ(report.at("dropped"), 2);
  EXPECT_EQ(report.at("skipped"), 1);
  EXPECT_EQ(report.at("maps"), 2);
  EXPECT_EQ(report.at("keyframes"), 4);
  EXPECT_EQ(report.at("landmarks"), 0);
  for (const char* key : {"cpu_seconds", "wall_seconds", "peak_rss_mib", "bytes_sent"}) {
    EXPECT_TRUE(report.at(key).is_number()) << key;
  }
  EXPECT_EQ(report.at("stages").at("tracking"),
            nlohmann::json({{"count", 7}, {"median_ms", 1.0}, {"mean_ms", 2.0}, {"p95_ms", 3.0}}));
}

TEST_F(AgentOutput, TheSummarySaysLoudlyWhatTheServerDidNotConfirm) {
  AgentRun run = RunWithTwoMaps();
  EXPECT_EQ(SummaryOf(run).find("NOT CONFIRMED"), std::string::npos);
  run.unconfirmed = Error{ErrorCode::kRefused, "the server goes on rejecting edits"};
  EXPECT_NE(SummaryOf(run).find("NOT CONFIRMED by the server: the server goes on rejecting"), std::string::npos);
  EXPECT_EQ(ReportOf(run).at("unconfirmed"), "the server goes on rejecting edits");
}

}  // namespace
}  // namespace pangaea
