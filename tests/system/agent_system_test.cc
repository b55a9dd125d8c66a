#include "tests/system/agent_system.h"

#include <gtest/gtest.h>

#include <csignal>
#include <random>

#include "common/base/text.h"
#include "tests/system/status_watch.h"

namespace pangaea {
namespace {

TEST_F(AgentSystem, AgentAndServerEndWithEqualDigests) {
  const auto server = StartServer();
  const auto agent = StartAgent("a1", 1);
  ASSERT_EQ(agent->Wait(), 0) << agent->output();
  server->Signal(SIGTERM);
  EXPECT_EQ(server->Wait(), 0) << server->output();
  ExpectServerHasAllOf("a1");
  EXPECT_EQ(Report("a1").at("frames"), kFrames);
}

TEST_F(AgentSystem, WhatTheServerAdjustsTheAgentHoldsInTheEnd) {
  const auto server = StartFullServer();
  const auto agent = StartAgent("a1", 1);
  ASSERT_EQ(agent->Wait(), 0) << agent->output();
  server->Signal(SIGTERM);
  EXPECT_EQ(server->Wait(), 0) << server->output();
  EXPECT_GE(Report("a1").at("corrections"), 1);
  ExpectServerHasAllOf("a1");
}

TEST_F(AgentSystem, WhatTheServerAdjustsTheAgentHoldsInTheEndAlsoWhenItWasKilledAndDoesNotKnowWhatItSaid) {
  const auto seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  StatusWatch status(kSite);
  auto server = StartFullServer();
  const auto agent = StartAgent("a1", 1);
  (void)status.WaitForAcknowledged(1, 3 + std::mt19937(seed)() % 6);
  server->Signal(SIGKILL);
  EXPECT_EQ(server->Wait(), 128 + SIGKILL);
  server = StartFullServer();
  EXPECT_EQ(agent->Wait(), 0) << agent->output();
  server->Signal(SIGTERM);
  EXPECT_EQ(server->Wait(), 0) << server->output();
  EXPECT_GE(Report("a1").at("corrections"), 1);
  ExpectServerHasAllOf("a1");
}

TEST_F(AgentSystem, ServerUnreachableFromTheStartTheAgentMapsOnAndLeavesItsEditsInTheSpillFile) {
  testing::WriteText(File("agent.yaml"), "uplink: {patience_s: 0.1}\n");
  const auto agent = StartAgent("a1", 1, {"--rate", "max"});
  EXPECT_EQ(agent->Wait(), 0) << agent->output();
  const json report = Report("a1");
  EXPECT_EQ(report.at("tracked"), kFrames);
  EXPECT_EQ(report.at("acknowledged"), false);
  ASSERT_EQ(SpillFiles().size(), 1U);
  EXPECT_GT(std::filesystem::file_size(SpillFiles().front()), 10'000U);
  EXPECT_NE(agent->output().find("NOT CONFIRMED"), std::string::npos) << agent->output();
  EXPECT_NE(agent->output().find(SpillFiles().front().filename().string()), std::string::npos) << agent->output();
}

TEST_F(AgentSystem, ServerKilledTwiceAndRestartedWhileTwoAgentsFlyNothingIsLostAndNothingTakenTwice) {
  // Other moments in every run; a failure names its seed.
  const auto seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  StatusWatch status(kSite);
  auto server = StartServer();
  const auto first = StartAgent("a1", 1);
  const auto second = StartAgent("a2", 2);
  std::uint64_t acknowledged = 0;
  for (std::uint64_t life = 1; life <= 2; ++life) {
    acknowledged = status.WaitForAcknowledged(life, acknowledged + 1 + random() % 10);
    server->Signal(SIGKILL);
    EXPECT_EQ(server->Wait(), 128 + SIGKILL);
    server = StartServer();
  }
  EXPECT_EQ(first->Wait(), 0) << first->output();
  EXPECT_EQ(second->Wait(), 0) << second->output();
  server->Signal(SIGTERM);
  EXPECT_EQ(server->Wait(), 0) << server->output();
  ExpectServerHasAllOf("a1");
  ExpectServerHasAllOf("a2");
}

TEST_F(AgentSystem, LinkCutForLongerThanTheLeaseAndJoinedAgainLosesNothing) {
  const auto server = StartServer();
  const auto agent = StartAgent("a1", 1);
  ASSERT_TRUE(agent->WaitForOutput("connected to the server")) << agent->output();
  ASSERT_TRUE(agent->WaitForOutput("started the first map")) << agent->output();
  server->Signal(SIGSTOP);
  ASSERT_TRUE(agent->WaitForOutput("lost the server")) << agent->output();
  server->Signal(SIGCONT);
  ASSERT_EQ(agent->Wait(), 0) << agent->output();
  server->Signal(SIGTERM);
  EXPECT_EQ(server->Wait(), 0) << server->output();
  ExpectServerHasAllOf("a1");
}

TEST_F(AgentSystem, AgentKilledItsSessionStaysInTheAtlas) {
  StatusWatch status(kSite);
  const auto server = StartServer();
  const auto agent = StartAgent("a1", 1);
  const std::uint64_t acknowledged = status.WaitForAcknowledged(1, 3);
  agent->Signal(SIGKILL);
  EXPECT_EQ(agent->Wait(), 128 + SIGKILL);
  server->Signal(SIGTERM);
  EXPECT_EQ(server->Wait(), 0) << server->output();
  EXPECT_GE(Stored("a1").at("acknowledged"), acknowledged);
  EXPECT_GE(Stored("a1").at("keyframes"), 1);
}

TEST_F(AgentSystem, CtrlCWithAServerEverythingInFlightIsSentAndTheFilesAreWritten) {
  for (const int signal : {SIGINT, SIGTERM}) {
    std::filesystem::remove(File("atlas.db"));
    const auto server = StartServer();
    const auto agent = StartAgent("a1", 1);
    ASSERT_TRUE(agent->WaitForOutput("connected to the server")) << agent->output();
    ASSERT_TRUE(agent->WaitForOutput("started the first map")) << agent->output();
    agent->Signal(signal);
    EXPECT_EQ(agent->Wait(), 0) << agent->output();
    server->Signal(SIGTERM);
    EXPECT_EQ(server->Wait(), 0) << server->output();
    const json report = Report("a1");
    EXPECT_LT(report.at("tracked"), kFrames) << "it was to end early";
    EXPECT_EQ(report.at("acknowledged"), true);
    EXPECT_EQ(report.at("agreed"), true);
    EXPECT_EQ(Stored("a1").at("digest"), report.at("digest"));
    EXPECT_TRUE(std::filesystem::exists(File("a1.tum")));
    EXPECT_TRUE(std::filesystem::exists(File("a1.live.tum")));
    EXPECT_TRUE(SpillFiles().empty());
  }
}

TEST_F(AgentSystem, CtrlCTwiceWithoutAServerEverythingIsSpilledAtOnce) {
  // The patience of a day would be seen.
  testing::WriteText(File("agent.yaml"), "uplink: {patience_s: 86400}\n");
  const auto agent = StartAgent("a1", 1);
  ASSERT_TRUE(agent->WaitForOutput("started the first map")) << agent->output();
  agent->Signal(SIGINT);
  ASSERT_TRUE(agent->WaitForOutput("waiting up to")) << agent->output();
  agent->Signal(SIGINT);
  EXPECT_EQ(agent->Wait(), 0) << agent->output();
  EXPECT_EQ(SpillFiles().size(), 1U);
  EXPECT_LT(Report("a1").at("tracked"), kFrames);
  EXPECT_TRUE(std::filesystem::exists(File("a1.tum")));
}

TEST_F(AgentSystem, WrongCalibrationIsAnErrorWithFileKeyAndRange) {
  testing::WriteEurocRecording(File("small"));
  const auto yaml = File("small/mav0/cam0/sensor.yaml");
  testing::Replace(yaml, "intrinsics: [60.0,", "intrinsics: [-60.0,");
  const std::string message = Refused({"--dataset", "small", "--no-server"});
  EXPECT_NE(message.find("sensor.yaml:"), std::string::npos) << message;
  EXPECT_NE(message.find("intrinsics"), std::string::npos) << message;
  EXPECT_NE(message.find("-60"), std::string::npos) << message;
  EXPECT_NE(message.find("allowed"), std::string::npos) << message;
}

TEST_F(AgentSystem, MissingCalibrationKeyIsAnErrorThatNamesIt) {
  testing::WriteEurocRecording(File("small"));
  testing::Replace(File("small/mav0/cam1/sensor.yaml"), "resolution:", "size:");
  const std::string message = Refused({"--dataset", "small", "--no-server"});
  EXPECT_NE(message.find("cam1/sensor.yaml"), std::string::npos) << message;
  EXPECT_NE(message.find("resolution"), std::string::npos) << message;
}

TEST_F(AgentSystem, MissingDatasetIsAnErrorThatNamesIt) {
  EXPECT_NE(Refused({"--dataset", "nowhere/at_all"}).find("nowhere/at_all"), std::string::npos);
  EXPECT_NE(Refused({"--dataset", "."}).find("EuRoC"), std::string::npos) << "the known layouts are named";
}

TEST_F(AgentSystem, BadOptionIsAnErrorThatNamesItAndWhatIsAllowed) {
  const Words dataset{"--dataset", Dataset(1)};
  const auto with = [&](const Words& more) {
    Words words = dataset;
    words.insert(words.end(), more.begin(), more.end());
    return Refused(words);
  };
  EXPECT_NE(with({"--frames", "3"}).find("--frames"), std::string::npos);
  EXPECT_NE(with({"--rate", "fast"}).find("--rate is 'fast'; allowed: realtime, max"), std::string::npos);
  EXPECT_NE(with({"--sensor", "sonar"}).find("--sensor is 'sonar'; allowed: stereo, mono"), std::string::npos);
  EXPECT_NE(with({"--site", "no spaces"}).find("no spaces"), std::string::npos);
  EXPECT_NE(with({"--domain", "231"}).find("0 to 230"), std::string::npos);
  EXPECT_NE(with({"--trajectory", "no/such/a.tum"}).find("no/such"), std::string::npos);
  EXPECT_NE(Refused({}).find("--dataset"), std::string::npos);
}

TEST_F(AgentSystem, UnknownConfigKeyAndValueOutOfRangeAreErrorsWithFileLineKeyAndRange) {
  testing::WriteText(File("bad.yaml"), "tracking:\n  min_inliers: 3\n  max_landmark: 10\n");
  const std::string message = Refused({"--dataset", Dataset(1), "--config", "bad.yaml"});
  EXPECT_NE(message.find("bad.yaml:2: tracking.min_inliers is '3'; allowed: 6 to 1000"), std::string::npos) << message;
  EXPECT_NE(message.find("bad.yaml:3:"), std::string::npos) << message;
  EXPECT_NE(message.find("max_landmarks"), std::string::npos) << "the nearest known key: " << message;
  EXPECT_NE(Refused({"--dataset", Dataset(1), "--config", "none.yaml"}).find("none.yaml"), std::string::npos);
}

TEST_F(AgentSystem, ImagesMissingCorruptOfAnotherSizeOrOutOfOrderAreSkippedWithOneWarningAndACount) {
  const std::filesystem::path copy = File("copy");
  std::filesystem::copy(Dataset(1), copy, std::filesystem::copy_options::recursive);
  std::vector<std::filesystem::path> images;
  for (const auto& entry : std::filesystem::directory_iterator(copy / "mav0/cam0/data")) images.push_back(entry.path());
  std::sort(images.begin(), images.end());
  ASSERT_EQ(images.size(), std::size_t{kFrames});
  std::filesystem::remove(images[30]);
  std::filesystem::resize_file(images[40], 1000);
  testing::WriteImage(images[50], 320, 240);
  testing::Replace(copy / "mav0/cam0/data.csv", images[60].stem().string(), images[20].stem().string());
  const auto agent = Start({PANGAEA_PROGRAMS "/pangaea-agent", "--dataset", "copy", "--rate", "max", "--no-server",
                            "--report", "copy.json"});
  EXPECT_EQ(agent->Wait(), 0) << agent->output();
  const json report = Report("copy");
  EXPECT_EQ(report.at("skipped"), 3) << agent->output();
  EXPECT_EQ(report.at("tracked").get<int>() + report.at("lost").get<int>() + 3, report.at("frames")) << report;
  EXPECT_NE(agent->output().find(images[30].filename().string()), std::string::npos) << agent->output();
  EXPECT_NE(agent->output().find("3 frames skipped"), std::string::npos) << agent->output();
}

TEST_F(AgentSystem, HelpAndVersionSucceed) {
  for (const char* option : {"--help", "--version"}) {
    const auto agent = Start({PANGAEA_PROGRAMS "/pangaea-agent", option});
    EXPECT_EQ(agent->Wait(), 0);
    EXPECT_NE(agent->output().find("pangaea-agent"), std::string::npos);
  }
}

}  // namespace
}  // namespace pangaea
