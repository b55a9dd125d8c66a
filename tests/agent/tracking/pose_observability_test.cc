#include "agent/tracking/pose_observability.h"

#include <gtest/gtest.h>

#include <random>

namespace pangaea {
namespace {

IdealCamera Camera() { return {752, 480, 450.0, 450.0, 375.5, 239.5, 0.11}; }

// A frame that found 200 landmarks about `depth` metres away, each where it is.
struct Scene {
  LocalMap local_map;
  LocatedFrame located;
};
Scene LookAt(double depth) {
  Scene scene;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> column(20.0, 730.0), row(20.0, 460.0), spread(0.8, 1.2);
  std::vector<PoseObservation> observations;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d pixel{column(random), row(random)};  // braces draw in order
    LocalLandmark& landmark = scene.local_map.landmarks.emplace_back();
    landmark.point_in_map = depth * spread(random) * Camera().Unproject(pixel);
    observations.push_back({landmark.point_in_map, {pixel.x(), pixel.y(), -1.0}, 1.0 / 0.5});
    LandmarkMatch match;
    match.landmark = i;
    match.pixel = pixel;
    scene.located.matches.push_back(match);
  }
  std::vector<std::uint8_t> inliers(observations.size());
  scene.located.pose = RefinePose(Camera(), Rigid3d(), observations, {}, inliers).value();
  return scene;
}

TEST(PoseObservability, NearLandmarksTellThePositionAndDistantOnesDoNot) {
  const ObservabilityOptions options;
  const Scene near = LookAt(4.0);
  EXPECT_TRUE(PositionIsObservable(near.located, near.local_map, true, options));
  const Scene far = LookAt(400.0);
  EXPECT_EQ(far.located.pose.inliers, 200);
  EXPECT_FALSE(PositionIsObservable(far.located, far.local_map, true, options));
}

TEST(PoseObservability, WithoutAScaleTheDistanceDoesNotMatterButHowWellTheLandmarksAreFoundDoes) {
  const ObservabilityOptions options;
  for (const double depth : {0.4, 4.0, 400.0}) {
    const Scene scene = LookAt(depth);
    EXPECT_TRUE(PositionIsObservable(scene.located, scene.local_map, false, options)) << depth;
  }
  Scene vague = LookAt(4.0);
  vague.located.pose.information /= 1e4;  // as if each were found to a hundred times as many pixels
  EXPECT_FALSE(PositionIsObservable(vague.located, vague.local_map, false, options));
}

TEST(PoseObservability, APoseThatIsNotDeterminedIsNotObservable) {
  Scene scene = LookAt(4.0);
  scene.located.pose.information.setZero();
  EXPECT_FALSE(PositionIsObservable(scene.located, scene.local_map, true, {}));
}

}  // namespace
}  // namespace pangaea
