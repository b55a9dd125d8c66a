#include "common/geometry/triangulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "common/geometry/reprojection.h"

namespace pangaea {
namespace {

constexpr double kDegree = 0.017453292519943295;

IdealCamera Camera() {
  return {.width = 752,
          .height = 480,
          .focal_x = 435.0,
          .focal_y = 437.0,
          .center_x = 367.0,
          .center_y = 252.0,
          .baseline = 0.11};
}

double Uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Eigen::Vector3d RandomPoint(std::mt19937_64& random, double nearest, double farthest) {
  // Braces, unlike parentheses, draw in order.
  return {Uniform(random, -2.0, 2.0), Uniform(random, -1.0, 1.0), Uniform(random, nearest, farthest)};
}

// Views of `point_in_map` from random places around the origin, looking along +z.
std::vector<PointView> MakeViews(std::mt19937_64& random, const Eigen::Vector3d& point_in_map, int count, double noise,
                                 bool stereo) {
  std::vector<PointView> views;
  for (int i = 0; i < count; ++i) {
    Vector6d twist;
    for (int k = 0; k < 6; ++k) twist(k) = Uniform(random, -1.0, 1.0) * (k < 3 ? 1.0 : 0.1);
    PointView view{Camera(), Rigid3d::Exp(twist), {}, 1.0};
    const Eigen::Vector3d point = view.camera_from_map * point_in_map;
    const Eigen::Vector2d pixel = view.camera.Project(point);
    view.measurement = {pixel.x(), pixel.y(), pixel.x() - view.camera.focal_x * view.camera.baseline / point.z()};
    for (int k = 0; k < 3; ++k) view.measurement(k) += Uniform(random, -noise, noise);
    if (!stereo) view.measurement.z() = -1.0;
    views.push_back(view);
  }
  return views;
}

TEST(TriangulateMidpoint, TwoRaysThroughAPointMeetThere) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    std::mt19937_64 random(seed);
    const Eigen::Vector3d point = RandomPoint(random, 3.0, 20.0);
    const auto views = MakeViews(random, point, 2, 0.0, false);
    const Ray a = PixelRay(views[0].camera, views[0].camera_from_map, views[0].measurement.head<2>());
    const Ray b = PixelRay(views[1].camera, views[1].camera_from_map, views[1].measurement.head<2>());
    const auto found = TriangulateMidpoint(a, b, 0.01 * kDegree);
    ASSERT_TRUE(found) << "seed " << seed;
    EXPECT_LT((*found - point).norm(), 1e-6) << "seed " << seed;
  }
}

TEST(TriangulateMidpoint, SkewRaysMeetInTheMiddleOfTheirShortestSegment) {
  const Ray a{{0.0, 0.0, 0.0}, {0.0, 0.0, 2.0}};
  const Ray b{{-3.0, 1.0, 3.0}, {1.0, 0.0, 0.0}};
  const auto found = TriangulateMidpoint(a, b, 0.0);
  ASSERT_TRUE(found);
  EXPECT_LT((*found - Eigen::Vector3d(0.0, 0.5, 3.0)).norm(), 1e-12);
}

TEST(TriangulateMidpoint, ParallelDivergingAndBrokenRaysDoNotMeet) {
  const Ray ahead{{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}};
  EXPECT_FALSE(TriangulateMidpoint(ahead, {{1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}}, 0.0));
  EXPECT_FALSE(TriangulateMidpoint(ahead, {{1.0, 0.0, 0.0}, {-0.01, 0.0, 1.0}}, 1.0 * kDegree));
  EXPECT_TRUE(TriangulateMidpoint(ahead, {{1.0, 0.0, 0.0}, {-0.01, 0.0, 1.0}}, 0.1 * kDegree));
  EXPECT_FALSE(TriangulateMidpoint(ahead, {{1.0, 0.0, 0.0}, {0.2, 0.0, 1.0}}, 0.1 * kDegree));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(TriangulateMidpoint(ahead, {{1.0, nan, 0.0}, {-0.2, 0.0, 1.0}}, 0.1 * kDegree));
  EXPECT_FALSE(TriangulateMidpoint(ahead, {{1.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}, 0.0));
}

TEST(ParallaxAngle, IsTheAngleBetweenDirections) {
  EXPECT_NEAR(ParallaxAngle({2.0, 0.0, 0.0}, {0.0, 3.0, 0.0}), 90.0 * kDegree, 1e-12);
  EXPECT_NEAR(ParallaxAngle({1.0, 0.0, 0.0}, {1.0, 1e-9, 0.0}), 1e-9, 1e-15);
}

TEST(RefinePoint, ExactViewsGiveTheExactPoint) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    std::mt19937_64 random(seed);
    const Eigen::Vector3d point = RandomPoint(random, 3.0, 10.0);
    const bool stereo = seed % 2 == 0;
    const auto views = MakeViews(random, point, stereo ? 1 : 3, 0.0, stereo);
    const auto refined = RefinePoint(views, 1.2 * point, {.max_iterations = 20});
    ASSERT_TRUE(refined) << "seed " << seed;
    EXPECT_LT((refined->point_in_map - point).norm(), 1e-5) << "seed " << seed;
    EXPECT_LT(refined->worst_chi2, 1e-6);
  }
}

TEST(RefinePoint, TheGradientVanishesAtNoisyViews) {
  std::mt19937_64 random(7);
  const Eigen::Vector3d point(0.5, -0.3, 6.0);
  const auto views = MakeViews(random, point, 5, 2.0, true);
  const auto refined = RefinePoint(views, point, {.max_iterations = 20, .step_tolerance = 1e-9});
  ASSERT_TRUE(refined);
  const auto cost = [&](const Eigen::Vector3d& at) {
    double sum = 0.0;
    for (const PointView& view : views) {
      sum += ReprojectionError(view.camera, view.camera_from_map * at, view.measurement).squaredNorm();
    }
    return sum;
  };
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d step = 1e-3 * Eigen::Vector3d::Unit(k);
    EXPECT_GT(cost(refined->point_in_map + step), cost(refined->point_in_map));
    EXPECT_GT(cost(refined->point_in_map - step), cost(refined->point_in_map));
  }
}

TEST(RefinePoint, WithoutParallaxOrInFrontOfNobodyThereIsNoPoint) {
  std::mt19937_64 random(8);
  const Eigen::Vector3d point(0.0, 0.0, 5.0);
  const auto one = MakeViews(random, point, 1, 0.0, false);
  EXPECT_FALSE(RefinePoint(one, point));
  const std::vector<PointView> twice = {one[0], one[0]};
  EXPECT_FALSE(RefinePoint(twice, point));
  EXPECT_FALSE(RefinePoint({}, point));
  const auto views = MakeViews(random, point, 3, 0.0, false);
  EXPECT_FALSE(RefinePoint(views, -point));
  auto broken = views;
  broken[1].measurement.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(RefinePoint(broken, point));
}

TEST(ReprojectionJacobian, IsTheNumericDerivative) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    std::mt19937_64 random(seed);
    const Eigen::Vector3d point = RandomPoint(random, 1.0, 10.0);
    const bool stereo = seed % 2 == 0;
    const Eigen::Vector3d measurement(10.0, 20.0, stereo ? 5.0 : -1.0);
    const Eigen::Matrix3d jacobian = ReprojectionJacobian(Camera(), point, stereo);
    const Eigen::Matrix<double, 3, 6> by_pose = jacobian * PerturbationJacobian(point);
    const double h = 1e-6;
    for (int k = 0; k < 6; ++k) {
      const auto error = [&](double step) {
        const Vector6d twist = step * Vector6d::Unit(k);
        return ReprojectionError(Camera(), Rigid3d::Exp(twist) * point, measurement);
      };
      const Eigen::Vector3d numeric = (error(h) - error(-h)) / (2.0 * h);
      EXPECT_LT((by_pose.col(k) - numeric).norm(), 1e-5 * (1.0 + numeric.norm())) << "seed " << seed << " k " << k;
    }
  }
}

}  // namespace
}  // namespace pangaea
