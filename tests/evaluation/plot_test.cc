#include "common/evaluation/plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/evaluation/plot_view.h"

namespace pangaea {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

PlotScene Hall() {
  PlotScene scene;
  scene.title = "Atlas of <site> & hall";
  PlotTrajectory trajectory;
  trajectory.name = "first";
  trajectory.pieces.emplace_back();
  for (int i = 0; i < 100; ++i) {
    trajectory.pieces[0].push_back({0.01 * i, 5.0 * std::cos(0.06 * i), 2.0 * std::sin(0.06 * i)});
  }
  trajectory.truth = trajectory.pieces[0];
  trajectory.keyframes = {trajectory.pieces[0][10]};
  trajectory.rms_error = 0.0123;
  trajectory.keyframe_count = 17;
  scene.trajectories.push_back(trajectory);
  for (int i = 0; i < 1000; ++i)
    scene.landmarks.push_back({std::sin(i), 6.0 * std::cos(3.0 * i), 3.0 * std::sin(3.0 * i)});
  return scene;
}

TEST(Plot, APictureNamesItsSessionsWithErrorAndKeyframes) {
  const std::string svg = DrawSvg(Hall());
  EXPECT_THAT(svg, ::testing::StartsWith("<svg"));
  EXPECT_THAT(svg, ::testing::EndsWith("</svg>\n"));
  EXPECT_THAT(svg, HasSubstr("ATE 0.0123 m"));
  EXPECT_THAT(svg, HasSubstr("17 keyframes"));
  EXPECT_THAT(svg, HasSubstr("ground truth"));
  EXPECT_THAT(svg, HasSubstr("1000 landmarks"));
  EXPECT_THAT(svg, HasSubstr("Atlas of &lt;site&gt; &amp; hall"));
}

TEST(Plot, EqualScenesGiveEqualBytes) { EXPECT_EQ(DrawSvg(Hall()), DrawSvg(Hall())); }

TEST(Plot, AnEmptySceneAndImpossibleNumbersStillGiveAPicture) {
  EXPECT_THAT(DrawSvg(PlotScene{}), HasSubstr("</svg>"));
  PlotScene scene = Hall();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  scene.landmarks.push_back({nan, 0.0, 0.0});
  scene.trajectories[0].pieces[0].push_back({0.0, nan, 0.0});
  scene.trajectories[0].keyframes.push_back({0.0, nan, 0.0});
  EXPECT_THAT(DrawSvg(scene), Not(HasSubstr("nan")));
}

TEST(Plot, TheLongestExtentLiesAcrossAndTheViewIsAlongTheShortest) {
  const PlotView view(Hall(), {.left = 0.0, .top = 0.0, .width = 800.0, .height = 600.0});
  const Eigen::Vector3d along = view.ToPlane({0.0, 1.0, 0.0}) - view.ToPlane({0.0, 0.0, 0.0});
  const Eigen::Vector3d height = view.ToPlane({1.0, 0.0, 0.0}) - view.ToPlane({0.0, 0.0, 0.0});
  EXPECT_GT(std::abs(along.x()), 0.99);
  EXPECT_GT(std::abs(height.z()), 0.95);
}

TEST(Plot, AKnownUpwardDirectionDecidesTheView) {
  PlotScene scene = Hall();
  scene.up = Eigen::Vector3d::UnitZ();
  const PlotView view(scene, {.left = 0.0, .top = 0.0, .width = 800.0, .height = 600.0});
  const Eigen::Vector3d up = view.ToPlane({0.0, 0.0, 1.0}) - view.ToPlane({0.0, 0.0, 0.0});
  EXPECT_NEAR(up.z(), 1.0, 1e-9);
}

TEST(Plot, EveryPositionOfATrajectoryIsInsideThePicture) {
  const PlotScene scene = Hall();
  const PlotView view(scene, {.left = 10.0, .top = 20.0, .width = 800.0, .height = 600.0});
  for (const Eigen::Vector3d& position : scene.trajectories[0].pieces[0]) {
    EXPECT_TRUE(view.Contains(view.ToPixel(position)));
  }
}

TEST(Plot, ManyLandmarksAreThinned) {
  PlotScene scene = Hall();
  PlotOptions options;
  const std::size_t all = DrawSvg(scene, options).size();
  options.max_landmarks = 100;
  EXPECT_LT(DrawSvg(scene, options).size() + 5000, all);
}

}  // namespace
}  // namespace pangaea
