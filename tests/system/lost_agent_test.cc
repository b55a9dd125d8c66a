// An agent that is lost in a place which another one has mapped.
#include <gtest/gtest.h>

#include <csignal>

#include "common/sensor/image.h"
#include "tests/system/agent_system.h"

namespace pangaea {
namespace {

// The second flight is the first one again, for the flights of a recording have little in common in so short a time. It
// sees for some seconds, which give it keyframes enough to be recognised by, then nothing until it is metres away from
// what it has mapped itself.
constexpr int kDarkFrom = 55;
constexpr int kDarkTo = 115;

// Replaces the images of these frames by black ones.
void Darken(const std::filesystem::path& dataset, int from, int to) {
  for (const char* camera : {"cam0", "cam1"}) {
    std::vector<std::filesystem::path> images;
    for (const auto& entry : std::filesystem::directory_iterator(dataset / "mav0" / camera / "data")) {
      images.push_back(entry.path());
    }
    std::sort(images.begin(), images.end());
    for (int i = from; i < to; ++i) {
      const auto& path = images.at(static_cast<std::size_t>(i));
      const auto size = ReadImageSize(path);
      ASSERT_TRUE(size) << size.error().message;
      testing::WriteImage(path, cv::Mat::zeros(size->height, size->width, CV_8UC1));
    }
  }
}

TEST_F(AgentSystem, ALostAgentGoesOnInTheMapOfAnother) {
  const auto server = Start({PANGAEA_PROGRAMS "/pangaea-server", "--site", kSite, "--store", "atlas.db"});
  const auto mapper = StartAgent("mapper", 1);
  ASSERT_EQ(mapper->Wait(), 0) << mapper->output();
  std::filesystem::copy(Dataset(1), File("dark"), std::filesystem::copy_options::recursive);
  Darken(File("dark"), kDarkFrom, kDarkTo);
  // Slow enough for the answer to come while there is something to see, on a busy machine or in an instrumented build.
  const auto lost = StartAgent("lost", 1, {"--dataset", File("dark").string(), "--rate", "0.4"});
  ASSERT_EQ(lost->Wait(), 0) << lost->output();
  server->Signal(SIGTERM);
  EXPECT_EQ(server->Wait(), 0) << server->output();
  EXPECT_NE(lost->output().find("the server knows the place"), std::string::npos) << lost->output();
  EXPECT_NE(lost->output().find("found the camera again"), std::string::npos) << lost->output();
  EXPECT_EQ(lost->output().find("started a new map"), std::string::npos) << lost->output();
  // Frames that show something, and are not too late for a machine that is busy.
  const json report = Report("lost");
  const int bright = kFrames - (kDarkTo - kDarkFrom);
  EXPECT_GE(report.at("tracked").get<int>() + report.at("dropped").get<int>(), bright * 9 / 10) << report;
  EXPECT_EQ(report.at("rejections"), 0);
  const auto digest = Start({PANGAEA_PROGRAMS "/pangaea", "digest", "--store", "atlas.db", "--json"});
  ASSERT_EQ(digest->Wait(), 0) << digest->output();
  EXPECT_EQ(json::parse(digest->output()).at("maps").size(), 1U) << server->output();
}

}  // namespace
}  // namespace pangaea
