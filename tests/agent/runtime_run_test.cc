#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "agent/runtime/agent_output.h"
#include "agent/runtime/agent_run.h"
#include "common/base/text.h"
#include "common/simulation/recording_writer.h"
#include "tests/sensor/recording.h"
#include "tests/sensor/temporary_folder.h"

namespace pangaea {
namespace {

constexpr int kFrames = 40;

// One short flight, drawn once for all tests.
class AgentRunTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<testing::TemporaryFolder>();
    RecordingOptions options;
    options.sessions = 1;
    options.seconds = 2.0;
    ASSERT_TRUE(WriteRecording(Recording(options), folder_->path(), [](int, int) {}));
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static std::filesystem::path Path(const std::string& name) { return folder_->path() / name; }
  static AgentOptions Options() {
    AgentOptions options;
    options.dataset = Path("session_1");
    options.rate = {0.0};
    options.use_server = false;
    return options;
  }
  static std::string RunInto(const std::string& name, AgentOptions options) {
    options.trajectory = Path(name);
    const auto run = RunAgent(options, {});
    EXPECT_TRUE(run) << run.error().message;
    if (!run) return "";
    EXPECT_TRUE(WriteOutputs(options, *run));
    return ReadTextFile(options.trajectory).value_or("");
  }

  static std::unique_ptr<testing::TemporaryFolder> folder_;
};
std::unique_ptr<testing::TemporaryFolder> AgentRunTest::folder_;

TEST_F(AgentRunTest, EveryFrameIsTrackedInOneMap) {
  const auto run = RunAgent(Options(), {});
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_EQ(run->source.frames, std::size_t{kFrames});
  EXPECT_EQ(run->tracked, std::size_t{kFrames});
  EXPECT_EQ(run->lost, 0U);
  EXPECT_EQ(run->source.dropped, 0U);
  EXPECT_EQ(run->live_trajectory.size(), std::size_t{kFrames});
  EXPECT_EQ(run->atlas->Maps().size(), 1U);
  EXPECT_GT(run->atlas->landmark_count(), 100U);
  EXPECT_FALSE(run->unconfirmed) << "nobody was to confirm anything";
}

TEST_F(AgentRunTest, TheReportMeasuresDecodingTrackingAndLocalMapping) {
  const auto run = RunAgent(Options(), {});
  ASSERT_TRUE(run) << run.error().message;
  const auto report = ReportOf(*run);
  EXPECT_EQ(report.at("stages").at("tracking").at("count"), kFrames);
  EXPECT_GE(report.at("stages").at("decode").at("count"), kFrames);
  EXPECT_GE(report.at("stages").at("local_mapping").at("count"), report.at("keyframes"));
  EXPECT_GT(report.at("cpu_seconds"), 0.0);
  EXPECT_GT(report.at("peak_rss_mib"), 0.0);
}

TEST_F(AgentRunTest, TwoDeterministicRunsGiveTheSameTrajectoryByteByByte) {
  AgentOptions options = Options();
  options.deterministic = true;
  const std::string first = RunInto("first.tum", options);
  EXPECT_GE(std::count(first.begin(), first.end(), '\n'), kFrames);
  EXPECT_EQ(RunInto("second.tum", options), first);
}

TEST_F(AgentRunTest, WithOneCameraTheFlightIsTrackedInOneMapFromTheFirstFrameOn) {
  AgentOptions options = Options();
  options.sensor = SensorKind::kMonocular;
  options.deterministic = true;
  const auto run = RunAgent(options, {});
  ASSERT_TRUE(run) << run.error().message;
  // Those before the two keyframes that the map began with get their poses later.
  EXPECT_EQ(run->tracked, std::size_t{kFrames});
  EXPECT_EQ(run->lost, 0U);
  EXPECT_LT(run->live_trajectory.size(), std::size_t{kFrames});
  EXPECT_EQ(run->atlas->Maps().size(), 1U);
  EXPECT_GT(run->atlas->landmark_count(), 100U);
  const std::string first = RunInto("mono_1.tum", options);
  EXPECT_EQ(std::count(first.begin(), first.end(), '\n'), kFrames);
  EXPECT_EQ(RunInto("mono_2.tum", options), first);
}

TEST_F(AgentRunTest, AStopEndsTheRunInOrder) {
  std::stop_source stop;
  stop.request_stop();
  const auto run = RunAgent(Options(), stop.get_token());
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_LT(run->tracked, std::size_t{kFrames});
}

TEST_F(AgentRunTest, ADatasetThatIsNotThereIsAnErrorThatNamesIt) {
  AgentOptions options = Options();
  options.dataset = "/nowhere/at_all";
  const auto run = RunAgent(options, {});
  ASSERT_FALSE(run);
  EXPECT_NE(run.error().message.find("/nowhere/at_all"), std::string::npos);
}

TEST_F(AgentRunTest, AVocabularyThatIsMissingIsNamedWithItsOption) {
  AgentOptions options = Options();
  options.vocabulary = "no_such_vocabulary.bin";
  const auto run = RunAgent(options, {});
  ASSERT_FALSE(run);
  EXPECT_NE(run.error().message.find("--vocabulary"), std::string::npos);
  EXPECT_NE(run.error().message.find("no_such_vocabulary.bin"), std::string::npos);
}

}  // namespace
}  // namespace pangaea
