#include <csignal>

#include "tests/system/agent_system.h"

namespace pangaea {
namespace {

TEST_F(AgentSystem, AnAgentThatForgetsHasTheSameMapAsTheServerInTheEnd) {
  RecordingOptions options;
  options.sessions = 1;
  options.seconds = 6.0;
  options.laps = 6;
  options.jobs = 2;
  ASSERT_TRUE(WriteRecording(Recording(options), File("laps"), [](int, int) {}));
  testing::WriteText(File("agent.yaml"), "memory: {max_keyframes: 5, kept_keyframes: 5}\n");
  const auto server = StartServer();
  const auto agent = StartAgent("a1", 1, {"--dataset", File("laps/session_1").string(), "--rate", "max"});
  ASSERT_EQ(agent->Wait(), 0) << agent->output();
  server->Signal(SIGTERM);
  EXPECT_EQ(server->Wait(), 0) << server->output();
  const json report = Report("a1");
  EXPECT_EQ(report.at("tracked"), 715);
  EXPECT_GT(report.at("times_forgotten"), 0);
  EXPECT_GT(report.at("forgotten").size(), 0U);
  EXPECT_EQ(report.at("rejections"), 0);
  EXPECT_NE(Stored("a1").at("digest"), report.at("digest")) << "the server has all of it";
  EXPECT_EQ(Stored("a1", {"--report", "a1.json"}).at("digest"), report.at("digest"));
}

}  // namespace
}  // namespace pangaea
