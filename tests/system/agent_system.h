#pragma once
// The programs as processes: a simulated flight, agents, server and the tools, over the loopback network.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/simulation/recording_writer.h"
#include "tests/sensor/recording.h"
#include "tests/sensor/temporary_folder.h"
#include "tests/system/program.h"

namespace pangaea {

using Words = std::vector<std::string>;
using nlohmann::json;

inline constexpr const char* kSite = "hall";
// Long enough for keyframes to be sent in flight: they settle after five seconds.
inline constexpr double kSeconds = 8.0;
inline constexpr int kFrames = 160;

class AgentSystem : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    // Other test programs on this machine are not to be seen.
    setenv("PANGAEA_DDS_TAG", ("system-test-" + std::to_string(getpid())).c_str(), 1);
    recordings_ = std::make_unique<testing::TemporaryFolder>();
    RecordingOptions options;
    options.sessions = 2;
    options.seconds = kSeconds;
    options.jobs = 2;
    ASSERT_TRUE(WriteRecording(Recording(options), recordings_->path(), [](int, int) {}));
  }
  static void TearDownTestSuite() { recordings_.reset(); }

  AgentSystem() {
    // Small envelopes: there are many to lose.
    testing::WriteText(File("agent.yaml"), "uplink: {envelope_bytes: 1000}\n");
  }

  std::filesystem::path File(const std::string& name) const { return folder_.path() / name; }
  static std::string Dataset(int session) {
    return (recordings_->path() / ("session_" + std::to_string(session))).string();
  }

  std::unique_ptr<Program> Start(Words words) const { return std::make_unique<Program>(words, folder_.path()); }
  // That only keeps what agents send: what they hold is compared with it.
  std::unique_ptr<Program> StartServer() const { return StartFullServer({"--no-recognition"}); }
  // That recognises, welds and adjusts as well.
  std::unique_ptr<Program> StartFullServer(const Words& more = {}) const {
    Words words{PANGAEA_PROGRAMS "/pangaea-server", "--site", kSite, "--store", "atlas.db"};
    words.insert(words.end(), more.begin(), more.end());
    return Start(words);
  }
  // An agent called `name` with all its files: name.tum, name.live.tum, name.json.
  std::unique_ptr<Program> StartAgent(const std::string& name, int session, const Words& more = {}) const {
    Words words{PANGAEA_PROGRAMS "/pangaea-agent",
                "--site",
                kSite,
                "--name",
                name,
                "--trajectory",
                name + ".tum",
                "--live-trajectory",
                name + ".live.tum",
                "--report",
                name + ".json"};
    words.insert(words.end(), more.begin(), more.end());
    if (std::find(more.begin(), more.end(), "--dataset") == more.end()) {
      words.insert(words.end(), {"--dataset", Dataset(session)});
    }
    if (std::find(more.begin(), more.end(), "--config") == more.end()) {
      words.insert(words.end(), {"--config", "agent.yaml"});
    }
    return Start(words);
  }
  // Runs an agent on arguments that are wrong. What it says.
  std::string Refused(const Words& arguments) const {
    Words words{PANGAEA_PROGRAMS "/pangaea-agent"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    const auto agent = Start(words);
    EXPECT_NE(agent->Wait(), 0) << agent->output();
    return agent->output();
  }

  json Report(const std::string& name) const {
    std::ifstream file(File(name + ".json"));
    return json::parse(file);
  }
  // The session of that name as the store has it.
  json Stored(const std::string& name, const Words& more = {}) const {
    Words words{PANGAEA_PROGRAMS "/pangaea", "digest", "--store", "atlas.db", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const auto digest = Start(words);
    EXPECT_EQ(digest->Wait(), 0) << digest->output();
    const json stored = json::parse(digest->output());
    for (const json& session : stored.at("sessions")) {
      if (session.at("name") == name) return session;
    }
    ADD_FAILURE() << "no session " << name << " in " << stored;
    return {};
  }
  void ExpectServerHasAllOf(const std::string& name) const {
    const json report = Report(name);
    const json stored = Stored(name);
    EXPECT_EQ(report.at("acknowledged"), true) << report;
    EXPECT_GT(report.at("keyframes"), 1);
    EXPECT_EQ(stored.at("digest"), report.at("digest")) << "lost something";
    // An envelope taken twice would contradict itself.
    EXPECT_EQ(stored.at("rejected"), 0);
    EXPECT_EQ(report.at("rejections"), 0);
    EXPECT_TRUE(SpillFiles().empty());
  }
  std::vector<std::filesystem::path> SpillFiles() const {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
      if (entry.path().extension() == ".spill") files.push_back(entry.path());
    }
    return files;
  }

  static inline std::unique_ptr<testing::TemporaryFolder> recordings_;
  testing::TemporaryFolder folder_;
};

}  // namespace pangaea
