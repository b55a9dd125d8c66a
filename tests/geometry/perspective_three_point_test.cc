#include "common/geometry/perspective_three_point.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

namespace pangaea {
namespace {

struct Scene {
  Rigid3d camera_from_map;
  std::array<Eigen::Vector3d, 3> points;
  std::array<Eigen::Vector3d, 3> bearings;
};

Scene MakeScene(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Scene scene;
  Vector6d twist;
  for (int k = 0; k < 6; ++k) twist(k) = uniform(-1.7, 1.7);
  scene.camera_from_map = Rigid3d::Exp(twist);
  for (int i = 0; i < 3; ++i) {
    const double depth = uniform(1.0, 20.0);
    const Eigen::Vector3d ray{uniform(-0.9, 0.9), uniform(-0.6, 0.6), 1.0};  // braces draw in order
    const Eigen::Vector3d point = depth * ray;
    scene.bearings[i] = point.normalized();
    scene.points[i] = scene.camera_from_map.Inverse() * point;
  }
  return scene;
}

double PoseDistance(const Rigid3d& a, const Rigid3d& b) { return (a * b.Inverse()).Log().norm(); }

TEST(PerspectiveThreePoint, TheTruePoseIsAmongTheSolutions) {
  int missed = 0;
  for (std::uint64_t seed = 0; seed < 10000; ++seed) {
    const Scene scene = MakeScene(seed);
    const ThreePointPoses poses = SolvePerspectiveThreePoint(scene.bearings, scene.points);
    double best = std::numeric_limits<double>::infinity();
    for (int i = 0; i < poses.count; ++i) {
      best = std::min(best, PoseDistance(poses.camera_from_map[i], scene.camera_from_map));
    }
    missed += best > 1e-6 ? 1 : 0;
  }
  // Near a double root the problem itself is ill-conditioned.
  EXPECT_LE(missed, 10);
}

TEST(PerspectiveThreePoint, EverySolutionExplainsTheBearingsAndNoneComesTwice) {
  int with_several = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    const Scene scene = MakeScene(seed);
    const ThreePointPoses poses = SolvePerspectiveThreePoint(scene.bearings, scene.points);
    with_several += poses.count > 1 ? 1 : 0;
    for (int i = 0; i < poses.count; ++i) {
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d bearing = (poses.camera_from_map[i] * scene.points[k]).normalized();
        EXPECT_LT((bearing - scene.bearings[k]).norm(), 1e-5) << "seed " << seed;
      }
    }
  }
  EXPECT_GT(with_several, 500);
}

TEST(PerspectiveThreePoint, SymmetricScenesAreSolvedToo) {
  // An equilateral triangle seen from above its centre: a root of the pencil is double.
  const std::array<Eigen::Vector3d, 3> points = {
      Eigen::Vector3d{1.0, 0.0, 4.0}, {-0.5, 0.8660254037844386, 4.0}, {-0.5, -0.8660254037844386, 4.0}};
  std::array<Eigen::Vector3d, 3> bearings;
  std::transform(points.begin(), points.end(), bearings.begin(),
                 [](const Eigen::Vector3d& p) { return p.normalized(); });
  const ThreePointPoses poses = SolvePerspectiveThreePoint(bearings, points);
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < poses.count; ++i) best = std::min(best, PoseDistance(poses.camera_from_map[i], Rigid3d()));
  EXPECT_LT(best, 1e-5);
}

TEST(PerspectiveThreePoint, CollinearAndBrokenPointsHaveNoSolution) {
  Scene scene = MakeScene(1);
  scene.points = {Eigen::Vector3d{0.0, 0.0, 5.0}, {1.0, 0.0, 5.0}, {2.0, 0.0, 5.0}};
  EXPECT_EQ(SolvePerspectiveThreePoint(scene.bearings, scene.points).count, 0);
  scene = MakeScene(2);
  scene.points[1] = scene.points[0];
  EXPECT_EQ(SolvePerspectiveThreePoint(scene.bearings, scene.points).count, 0);
  scene = MakeScene(3);
  scene.points[2].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(SolvePerspectiveThreePoint(scene.bearings, scene.points).count, 0);
  scene = MakeScene(4);
  scene.bearings[0].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(SolvePerspectiveThreePoint(scene.bearings, scene.points).count, 0);
}

}  // namespace
}  // namespace pangaea
