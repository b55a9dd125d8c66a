#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/side_by_side.h"
#include "common/base/text.h"
#include "tests/cli/command_run.h"
#include "tests/cli/recorded_store.h"
#include "tests/sensor/recording.h"
#include "tests/sensor/temporary_folder.h"

namespace pangaea {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::RunPangaea;

class PlotFromStore : public ::testing::Test {
 protected:
  PlotFromStore() {
    testing::WriteEurocRecording(dataset());
    testing::WriteStore(store(),
                        {{.id = 1, .name = "flight"}, {.id = 2, .name = "later", .delay_ns = 1'000'000'000'000}});
  }
  std::string Path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string dataset() const { return Path("flight"); }
  std::string store() const { return Path("atlas.db"); }
  std::string picture() const { return ReadTextFile(Path("x.svg")).value_or(""); }

  testing::TemporaryFolder folder_;
};

TEST_F(PlotFromStore, TruthIsDrawnAndItsSessionsErrorTold) {
  const auto run = RunPangaea({"plot", "--store", store(), "--truth", dataset(), "--out", Path("x.svg")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(picture(), HasSubstr("ground truth"));
  EXPECT_THAT(picture(), HasSubstr("ATE 0.0000 m"));
  EXPECT_THAT(picture(), HasSubstr("12 landmarks"));
  EXPECT_THAT(picture(), HasSubstr("later"));
}

TEST_F(PlotFromStore, AnAtlasNeedsNoTruth) {
  const auto run = RunPangaea({"plot", "--store", store(), "--title", "Our hall", "--out", Path("x.svg")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(picture(), HasSubstr("Our hall"));
  EXPECT_THAT(picture(), Not(HasSubstr("ATE")));
}

TEST_F(PlotFromStore, TrajectoriesOfFilesAreDrawnToo) {
  ASSERT_EQ(RunPangaea({"export", "--store", store(), "--session", "flight", "--out", Path("a.tum")}).exit_code, 0);
  const auto run = RunPangaea({"plot", "--trajectory", Path("a.tum"), "--truth", dataset(), "--out", Path("x.svg")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(picture(), HasSubstr("ATE"));
}

TEST_F(PlotFromStore, WhatCannotBeReadOrWrittenIsNamed) {
  auto run = RunPangaea({"plot", "--store", Path("none.db"), "--out", Path("x.svg")});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("none.db"));
  run = RunPangaea({"plot", "--store", store(), "--out", Path("no/such/folder/x.svg")});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("no/such/folder"));
  EXPECT_EQ(RunPangaea({"plot", "--out", Path("x.svg")}).exit_code, 2);
  EXPECT_EQ(RunPangaea({"plot", "--store", store()}).exit_code, 2);
}

PlotScene WayAlong(const Eigen::Vector3d& direction, const Eigen::Vector3d& up) {
  PlotScene scene;
  scene.up = up;
  scene.trajectories.emplace_back();
  scene.trajectories.back().pieces.emplace_back();
  for (int i = 0; i < 20; ++i) scene.trajectories.back().pieces.back().push_back(0.5 * i * direction);
  return scene;
}

TEST(SideBySide, ScenesOfOtherFramesAreLevelledAndDoNotTouch) {
  const PlotScene scene = PlaceSideBySide({WayAlong(Eigen::Vector3d::UnitZ(), -Eigen::Vector3d::UnitY()),
                                           WayAlong(Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ())});
  ASSERT_EQ(scene.trajectories.size(), 2u);
  const auto& first = scene.trajectories[0].pieces[0];
  const auto& second = scene.trajectories[1].pieces[0];
  // Both lie along x, the second below the first.
  EXPECT_NEAR(std::abs(first.back().x() - first.front().x()), 9.5, 1e-9);
  EXPECT_NEAR(first.back().y(), first.front().y(), 1e-9);
  EXPECT_NEAR(first.back().z(), first.front().z(), 1e-9);
  EXPECT_GT(first.front().y() - second.front().y(), 3.0);
}

TEST(SideBySide, ASingleSceneStaysAsItIs) {
  const PlotScene scene = PlaceSideBySide({WayAlong({0.6, 0.8, 0.0}, Eigen::Vector3d::UnitZ())});
  EXPECT_EQ(scene.trajectories[0].pieces[0].back(), Eigen::Vector3d(0.5 * 19 * Eigen::Vector3d(0.6, 0.8, 0.0)));
}

}  // namespace
}  // namespace pangaea
