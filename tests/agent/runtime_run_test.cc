#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <pangaea_lcm/pose_t.hpp>
#include <pangaea_lcm/statistics_t.hpp>
#include <string>
#include <vector>

#include "agent/runtime/agent_output.h"
#include "agent/runtime/agent_run.h"
#include "agent/runtime/frozen_picture.h"
#include "common/base/text.h"
#include "common/lcm/message_codec.h"
#include "common/lcm/pose_codec.h"
#include "common/lcm/receiver.h"
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
  // Returns the copy's left images in order.
  static std::vector<std::filesystem::path> CopyRecording(const std::filesystem::path& to) {
    std::filesystem::copy(Path("session_1"), to, std::filesystem::copy_options::recursive);
    std::vector<std::filesystem::path> images;
    for (const auto& entry : std::filesystem::directory_iterator(to / "mav0/cam0/data")) images.push_back(entry.path());
    std::sort(images.begin(), images.end());
    return images;
  }
  static void Repeat(const std::filesystem::path& image, const std::filesystem::path& instead_of) {
    std::filesystem::copy_file(image, instead_of, std::filesystem::copy_options::overwrite_existing);
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
  EXPECT_EQ(run->flight.tracked, std::size_t{kFrames});
  EXPECT_EQ(run->flight.lost, 0U);
  EXPECT_EQ(run->source.dropped, 0U);
  EXPECT_EQ(run->flight.live_trajectory.size(), std::size_t{kFrames});
  EXPECT_EQ(run->atlas->Maps().size(), 1U);
  EXPECT_GT(run->atlas->landmark_count(), 100U);
  EXPECT_FALSE(run->unconfirmed) << "nobody was to confirm anything";
}

TEST_F(AgentRunTest, TheLastFrameIsAKeyframe) {
  for (const bool deterministic : {true, false}) {
    AgentOptions options = Options();
    options.deterministic = deterministic;
    const auto run = RunAgent(options, {});
    ASSERT_TRUE(run) << run.error().message;
    std::int64_t newest_ns = 0;
    run->atlas->ForEachKeyframe(
        [&](const Keyframe& keyframe) { newest_ns = std::max(newest_ns, keyframe.data->stamp_ns); });
    EXPECT_EQ(newest_ns, run->flight.live_trajectory.back().stamp_ns) << deterministic;
  }
}

TEST_F(AgentRunTest, TheReportMeasuresDecodingTrackingAndLocalMapping) {
  const auto run = RunAgent(Options(), {});
  ASSERT_TRUE(run) << run.error().message;
  const auto report = ReportOf(*run);
  EXPECT_EQ(report.at("stages").at("tracking").at("count"), kFrames);
  EXPECT_GE(report.at("stages").at("decode").at("count"), kFrames);
  EXPECT_GE(report.at("stages").at("local_mapping").at("count"), report.at("keyframes"));
  EXPECT_GE(report.at("stages").at("keyframe.extract").at("count"), report.at("keyframes"));
  EXPECT_GE(report.at("stages").at("keyframe.stereo").at("count"), report.at("keyframes"));
  EXPECT_EQ(report.at("stages").at("mapping.wide_adjustment").at("count"), 1) << "before the map was closed";
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
  EXPECT_EQ(run->flight.tracked, std::size_t{kFrames});
  EXPECT_EQ(run->flight.lost, 0U);
  EXPECT_LT(run->flight.live_trajectory.size(), std::size_t{kFrames});
  EXPECT_EQ(run->atlas->Maps().size(), 1U);
  EXPECT_GT(run->atlas->landmark_count(), 100U);
  const std::string first = RunInto("mono_1.tum", options);
  EXPECT_EQ(std::count(first.begin(), first.end(), '\n'), kFrames);
  EXPECT_EQ(RunInto("mono_2.tum", options), first);
}

TEST_F(AgentRunTest, RightImagesThatCannotBeReadCostDepthAndNothingElse) {
  for (const bool deterministic : {true, false}) {
    AgentOptions options = Options();
    options.deterministic = deterministic;
    options.dataset = Path(deterministic ? "one_eye_deterministic" : "one_eye");
    CopyRecording(options.dataset);
    std::vector<std::filesystem::path> right;
    for (const auto& entry : std::filesystem::directory_iterator(options.dataset / "mav0/cam1/data")) {
      right.push_back(entry.path());
    }
    std::sort(right.begin(), right.end());
    for (std::size_t i = 1; i < right.size(); ++i) std::filesystem::resize_file(right[i], 20);
    const auto run = RunAgent(options, {});
    ASSERT_TRUE(run) << run.error().message;
    EXPECT_EQ(run->flight.tracked, std::size_t{kFrames});
    EXPECT_EQ(run->atlas->Maps().size(), 1U);
    std::size_t with_depth = 0;
    run->atlas->ForEachKeyframe([&](const Keyframe& keyframe) {
      with_depth += std::ranges::any_of(keyframe.data->features.keypoints, &Keypoint::has_depth) ? 1 : 0;
    });
    EXPECT_GT(run->atlas->keyframe_count(), 1U);
    EXPECT_EQ(with_depth, 1U) << "the first one alone";
  }
}

TEST_F(AgentRunTest, APictureThatFreezesGivesNoPoses) {
  constexpr std::size_t kFrozenFrom = 20;
  constexpr std::size_t kFrozenTo = 29;
  AgentOptions options = Options();
  options.deterministic = true;
  options.dataset = Path("frozen");
  const std::vector<std::filesystem::path> images = CopyRecording(options.dataset);
  for (std::size_t i = kFrozenFrom; i < kFrozenTo; ++i) Repeat(images[kFrozenFrom - 1], images[i]);
  const auto run = RunAgent(options, {});
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_LE(run->flight.tracked, kFrames - (kFrozenTo - kFrozenFrom));
  EXPECT_GE(run->flight.tracked, kFrames - (kFrozenTo - kFrozenFrom) - 2) << "and found again soon";
  EXPECT_EQ(run->source.skipped, std::size_t{FrozenPicture::kMostDoubles});
  EXPECT_EQ(run->atlas->Maps().size(), 1U);
  for (const StampedPose& pose : run->flight.live_trajectory) {
    const std::string stamp = std::to_string(pose.stamp_ns);
    for (std::size_t i = kFrozenFrom; i < kFrozenTo; ++i) EXPECT_NE(images[i].stem(), stamp);
  }
}

TEST_F(AgentRunTest, AMonocularMapBeginsInAVideoWhereEveryFourthFrameIsADouble) {
  AgentOptions options = Options();
  options.sensor = SensorKind::kMonocular;
  options.deterministic = true;
  options.dataset = Path("doubled");
  const std::vector<std::filesystem::path> images = CopyRecording(options.dataset);
  for (std::size_t i = 3; i < images.size(); i += 4) Repeat(images[i - 1], images[i]);
  const auto run = RunAgent(options, {});
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_EQ(run->source.skipped, images.size() / 4);
  EXPECT_EQ(run->flight.tracked, images.size() - images.size() / 4);
  EXPECT_EQ(run->atlas->Maps().size(), 1U);
}

// Every message of the agent's, by channel.
std::map<std::string, std::vector<LcmPayload>> MessagesOf(const std::string& url, const LcmChannels& channels) {
  std::map<std::string, std::vector<LcmPayload>> messages;
  const auto receiver =
      LcmReceiver::Open(*LcmUrl::Parse(url), {channels.pose, channels.tracking_state, channels.statistics});
  EXPECT_TRUE(receiver);
  while (auto message = (*receiver)->Next({})) messages[(*message)->channel].push_back((*message)->payload);
  return messages;
}

TEST_F(AgentRunTest, EachFrameIsToldOnLcmAndThePosesAreTheLiveOnes) {
  AgentOptions options = Options();
  options.deterministic = true;
  options.lcm_output = "file://" + Path("state.lcm").string();
  const auto run = RunAgent(options, {});
  ASSERT_TRUE(run) << run.error().message;
  auto messages = MessagesOf(options.lcm_output, options.lcm);
  const auto& poses = messages[options.lcm.pose];
  ASSERT_EQ(poses.size(), run->flight.live_trajectory.size());
  EXPECT_EQ(messages[options.lcm.tracking_state].size(), std::size_t{kFrames + 1}) << "and that it has finished";
  std::optional<Rigid3d> previous;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto pose = DecodeMessage<pangaea_lcm::pose_t>(poses[i]);
    ASSERT_TRUE(pose);
    EXPECT_EQ(pose->stamp_ns, run->flight.live_trajectory[i].stamp_ns);
    const Rigid3d odom_from_body = *RigidOf(pose->odom_from_body);
    const Rigid3d map_from_body = *RigidOf(pose->map_from_odom) * odom_from_body;
    EXPECT_LT((map_from_body.Inverse() * run->flight.live_trajectory[i].world_from_body).Log().norm(), 1e-9);
    // At one metre a second and 20 Hz.
    EXPECT_LT((odom_from_body.translation() - previous.value_or(odom_from_body).translation()).norm(), 0.2);
    EXPECT_FALSE(pose->discontinuity);
    previous = odom_from_body;
  }
  const auto statistics = DecodeMessage<pangaea_lcm::statistics_t>(messages[options.lcm.statistics].back());
  ASSERT_TRUE(statistics);
  EXPECT_EQ(statistics->frames, kFrames);
  EXPECT_EQ(statistics->tracked, kFrames);
  EXPECT_GT(statistics->memory_mib, 1.0);
  EXPECT_GT(statistics->landmarks, 100);
}

TEST_F(AgentRunTest, AStopEndsTheRunInOrder) {
  std::stop_source stop;
  stop.request_stop();
  const auto run = RunAgent(Options(), stop.get_token());
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_LT(run->flight.tracked, std::size_t{kFrames});
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
