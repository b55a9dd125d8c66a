// A recording that goes over LCM from one process to another.
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <pangaea_lcm/statistics_t.hpp>

#include "common/base/text.h"
#include "common/lcm/message_codec.h"
#include "common/simulation/recording_writer.h"
#include "tests/lcm/network.h"
#include "tests/sensor/temporary_folder.h"
#include "tests/system/program.h"

namespace pangaea {
namespace {

using Words = std::vector<std::string>;

constexpr double kSeconds = 3.0;
constexpr int kFrames = 60;

class LcmSystem : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    recordings_ = std::make_unique<testing::TemporaryFolder>();
    RecordingOptions options;
    options.sessions = 1;
    options.seconds = kSeconds;
    options.jobs = 2;
    ASSERT_TRUE(WriteRecording(Recording(options), recordings_->path(), [](int, int) {}));
  }
  static void TearDownTestSuite() { recordings_.reset(); }

  static std::string Flight() { return (recordings_->path() / "session_1").string(); }
  std::string File(const std::string& name) const { return (folder_.path() / name).string(); }

  std::unique_ptr<Program> Start(const std::string& program, const Words& arguments) const {
    Words words{PANGAEA_PROGRAMS "/" + program};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return std::make_unique<Program>(words, folder_.path());
  }
  std::unique_ptr<Program> StartAgent(const std::string& name, Words arguments) const {
    arguments.insert(arguments.end(),
                     {"--no-server", "--rate", "max", "--trajectory", name + ".tum", "--report", name + ".json"});
    return Start("pangaea-agent", arguments);
  }
  nlohmann::json Report(const std::string& name) const {
    std::ifstream file(File(name + ".json"));
    return nlohmann::json::parse(file);
  }

  static std::unique_ptr<testing::TemporaryFolder> recordings_;
  testing::TemporaryFolder folder_;
};
std::unique_ptr<testing::TemporaryFolder> LcmSystem::recordings_;

TEST_F(LcmSystem, ALogOfARecordingGivesTheSameTrajectoryByteByByte) {
  const auto publisher = Start("pangaea", {"lcm-publish", Flight(), "--lcm", "file://flight.lcm"});
  ASSERT_EQ(publisher->Wait(), 0) << publisher->output();
  const auto direct = StartAgent("direct", {"--dataset", Flight(), "--deterministic"});
  ASSERT_EQ(direct->Wait(), 0) << direct->output();
  const auto replayed = StartAgent("replayed", {"--lcm", "file://flight.lcm", "--deterministic"});
  ASSERT_EQ(replayed->Wait(), 0) << replayed->output();
  const std::string expected = ReadTextFile(File("direct.tum")).value_or("");
  EXPECT_EQ(std::count(expected.begin(), expected.end(), '\n'), kFrames);
  EXPECT_EQ(ReadTextFile(File("replayed.tum")).value_or(""), expected);
  EXPECT_EQ(Report("replayed").at("frames"), kFrames);
}

TEST_F(LcmSystem, LiveStereoAtTwentyHertzLosesNoFrame) {
  if (!testing::MulticastWorks()) GTEST_SKIP() << testing::kNoMulticast;
  const std::string network = testing::OwnNetwork();
  const auto statistics = LcmReceiver::Open(*LcmUrl::Parse(network), {"PANGAEA_STATISTICS"});
  ASSERT_TRUE(statistics) << statistics.error().message;
  const auto agent = StartAgent("live", {"--lcm", network, "--lcm-output", network});
  ASSERT_TRUE(agent->WaitForOutput("waiting for a calibration")) << agent->output();
  const auto publisher = Start("pangaea", {"lcm-publish", Flight(), "--lcm", network});

  const testing::Deadline deadline(std::chrono::seconds(120));
  std::int64_t frames = 0;
  while (frames < kFrames) {
    const auto message = (*statistics)->Next(deadline.token());
    ASSERT_TRUE(message && *message) << "after " << frames << " frames; " << agent->output();
    const auto decoded = DecodeMessage<pangaea_lcm::statistics_t>((*message)->payload);
    ASSERT_TRUE(decoded);
    frames = decoded->frames;
  }
  EXPECT_EQ(publisher->Wait(), 0) << publisher->output();
  agent->Signal(SIGTERM);
  ASSERT_EQ(agent->Wait(), 0) << agent->output();
  const auto report = Report("live");
  EXPECT_EQ(report.at("frames"), kFrames);
  EXPECT_EQ(report.at("tracked"), kFrames);
  EXPECT_EQ(report.at("missing"), 0);
  EXPECT_EQ(report.at("skipped"), 0);
  EXPECT_EQ(report.at("dropped"), 0);
}

TEST_F(LcmSystem, AStopWhileTheAgentWaitsForACameraEndsIt) {
  if (!testing::MulticastWorks()) GTEST_SKIP() << testing::kNoMulticast;
  const auto agent = StartAgent("waiting", {"--lcm", testing::OwnNetwork()});
  ASSERT_TRUE(agent->WaitForOutput("waiting for a calibration")) << agent->output();
  agent->Signal(SIGINT);
  EXPECT_EQ(agent->Wait(), 0) << agent->output();
}

TEST_F(LcmSystem, WrongInputsAreErrorsThatSayWhatIsAllowed) {
  const auto expect = [&](const Words& arguments, const std::string& what) {
    const auto agent = Start("pangaea-agent", arguments);
    EXPECT_EQ(agent->Wait(), 2);
    EXPECT_NE(agent->output().find(what), std::string::npos) << agent->output();
  };
  expect({}, "0 inputs are given; allowed: exactly one of --dataset, --video, --lcm");
  expect({"--dataset", Flight(), "--lcm", "file://flight.lcm"}, "2 inputs are given");
  expect({"--video", "0"}, "--video needs --calibration");
  expect({"--lcm", "tcpq://somewhere"}, "allowed: udpm://");
}

}  // namespace
}  // namespace pangaea
