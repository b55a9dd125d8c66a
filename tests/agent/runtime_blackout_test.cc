#include <gtest/gtest.h>

#include <algorithm>

#include "agent/runtime/agent_output.h"
#include "agent/runtime/agent_run.h"
#include "common/base/text.h"
#include "common/evaluation/absolute_error.h"
#include "common/simulation/recording_writer.h"
#include "tests/sensor/temporary_folder.h"

namespace pangaea {
namespace {

// What `pangaea simulate --seconds 4 --blur 3 --exposure-drift 0.3 --blackout 1:2 --blackout 2.6:3.1` writes: motion
// blur, an exposure that swings, and twice only dark noise.
class AgentBlackoutTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<testing::TemporaryFolder>();
    RecordingOptions options;
    options.sessions = 1;
    options.seconds = 4.0;
    options.blur = 3;
    options.exposure_drift = 0.3;
    options.blackouts = {{1.0, 2.0}, {2.6, 3.1}};
    recording_ = std::make_unique<Recording>(options);
    ASSERT_TRUE(WriteRecording(*recording_, folder_->path(), [](int, int) {}));
  }
  static void TearDownTestSuite() {
    recording_.reset();
    folder_.reset();
  }

  static Result<AgentRun> Run(std::uint64_t seed = 1) {
    AgentOptions options;
    options.dataset = folder_->path() / "session_1";
    options.rate = {0.0};
    options.use_server = false;
    options.deterministic = true;
    options.seed = seed;
    options.trajectory = folder_->path() / "run.tum";
    auto run = RunAgent(options, {});
    EXPECT_TRUE(run && WriteOutputs(options, *run));
    return run;
  }
  // All trajectory files of the latest run, one after the other.
  static std::string Trajectories() {
    std::string all;
    for (const char* name : {"run.tum", "run.2.tum", "run.3.tum"}) {
      all += ReadTextFile(folder_->path() / name).value_or("") + "\n";
    }
    return all;
  }
  // Frames that show something.
  static std::vector<std::int64_t> BrightFrames() {
    std::vector<std::int64_t> stamps;
    for (int frame = 0; frame < recording_->frame_count(); ++frame) {
      const std::int64_t stamp = recording_->FrameStamp(0, frame);
      if (!recording_->IsBlackedOut(recording_->Seconds(0, stamp))) stamps.push_back(stamp);
    }
    return stamps;
  }

  static std::unique_ptr<testing::TemporaryFolder> folder_;
  static std::unique_ptr<Recording> recording_;
};
std::unique_ptr<testing::TemporaryFolder> AgentBlackoutTest::folder_;
std::unique_ptr<Recording> AgentBlackoutTest::recording_;

TEST_F(AgentBlackoutTest, EveryFrameThatShowsSomethingIsTrackedInOneMapAndNoDarkOne) {
  const auto run = Run();
  ASSERT_TRUE(run) << run.error().message;
  std::vector<std::int64_t> tracked;
  for (const StampedPose& pose : run->flight.live_trajectory) tracked.push_back(pose.stamp_ns);
  EXPECT_EQ(tracked, BrightFrames());
  EXPECT_EQ(run->atlas->Maps().size(), 1U);

  EvaluatedTrajectory evaluated;
  evaluated.estimate = run->flight.live_trajectory;
  for (const TruthSample& sample : recording_->GroundTruth(0)) {
    evaluated.truth.push_back({sample.stamp_ns, sample.world_from_body});
  }
  const auto error = EvaluateAbsoluteError(std::vector{evaluated});
  ASSERT_TRUE(error);
  EXPECT_LT(error->error.rms, 0.03);
}

TEST_F(AgentBlackoutTest, TwoDeterministicRunsGiveTheSameTrajectoriesByteByByte) {
  ASSERT_TRUE(Run());
  const std::string first = Trajectories();
  EXPECT_GT(std::count(first.begin(), first.end(), '\n'), 40);
  ASSERT_TRUE(Run());
  EXPECT_EQ(Trajectories(), first);
}

}  // namespace
}  // namespace pangaea
