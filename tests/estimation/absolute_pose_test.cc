#include "common/estimation/absolute_pose.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/estimation/synthetic_world.h"

namespace pangaea::testing {
namespace {

TEST(AbsolutePose, IsFoundAmongFortyAndSeventyPercentOutliers) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    for (const double ratio : {0.4, 0.7}) {
      const PoseWorld world =
          MakePoseWorld(seed, {.observations = 200, .noise = 0.5, .outlier_ratio = ratio, .stereo = seed % 2 == 0});
      const auto result = EstimateAbsolutePose(world.camera, world.observations, {}, seed);
      ASSERT_TRUE(result) << "seed " << seed;
      const Vector6d error = (result->pose.camera_from_map * world.camera_from_map.Inverse()).Log();
      EXPECT_LT(error.head<3>().norm(), 0.05) << "seed " << seed << " ratio " << ratio;
      EXPECT_LT(error.tail<3>().norm(), 0.01) << "seed " << seed << " ratio " << ratio;
      EXPECT_EQ(std::count(result->inliers.begin(), result->inliers.end(), 1), result->pose.inliers);
    }
  }
}

TEST(AbsolutePose, TheSameSeedGivesTheSameAnswer) {
  const PoseWorld world = MakePoseWorld(1, {.observations = 150, .noise = 1.0, .outlier_ratio = 0.5});
  const auto a = EstimateAbsolutePose(world.camera, world.observations, {}, 42);
  const auto b = EstimateAbsolutePose(world.camera, world.observations, {}, 42);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->inliers, b->inliers);
  EXPECT_EQ(a->iterations, b->iterations);
  EXPECT_EQ(a->pose.camera_from_map.Matrix(), b->pose.camera_from_map.Matrix());
}

TEST(AbsolutePose, RandomMatchesGiveNoPose) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const PoseWorld world = MakePoseWorld(seed, {.observations = 100, .outlier_ratio = 1.0});
    EXPECT_FALSE(EstimateAbsolutePose(world.camera, world.observations, {}, seed)) << "seed " << seed;
  }
}

TEST(AbsolutePose, NonFiniteMatchesAreOutliersAndTooFewAreNoPose) {
  PoseWorld world = MakePoseWorld(2, {.observations = 60});
  for (int i = 0; i < 10; ++i) {
    world.observations[i].measurement.x() = std::numeric_limits<double>::quiet_NaN();
    world.observations[10 + i].point_in_map.z() = std::numeric_limits<double>::infinity();
  }
  const auto result = EstimateAbsolutePose(world.camera, world.observations, {}, 3);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->pose.inliers, 40);
  EXPECT_FALSE(EstimateAbsolutePose(world.camera, {}, {}, 3));
  EXPECT_FALSE(EstimateAbsolutePose(world.camera, std::span(world.observations).first(2), {}, 3));
}

}  // namespace
}  // namespace pangaea::testing
