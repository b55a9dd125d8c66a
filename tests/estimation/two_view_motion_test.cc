#include "common/estimation/two_view_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/estimation/synthetic_world.h"

namespace pangaea::testing {
namespace {

struct TwoViewWorldOptions {
  std::size_t matches = 300;
  double noise = 0.5;          // pixels
  double outlier_ratio = 0.0;  // matches with a second pixel anywhere
  bool plane = false;
  double beside_plane = 0.0;  // share of the points that stand elsewhere
  double nearest = 3.0;
  double farthest = 12.0;
  Eigen::Vector3d step = {0.4, 0.1, 0.05};  // of the second camera, in the first one's frame
  double turn = 0.1;                        // radians at most, about each axis
};

struct TwoViewWorld {
  Rigid3d second_from_first;
  std::vector<PixelMatch> matches;
  std::vector<Eigen::Vector3d> points_in_first;
  std::vector<bool> is_outlier;
};

TwoViewWorld MakeTwoViewWorld(std::uint64_t seed, const TwoViewWorldOptions& options) {
  Random random(seed);
  const IdealCamera camera = MonocularCamera();
  TwoViewWorld world;
  world.second_from_first = Rigid3d(ExpSo3(UniformVector(random, options.turn)), options.step).Inverse();
  const Eigen::Vector3d slope{Uniform(random, -0.5, 0.5), Uniform(random, -0.5, 0.5), 0.0};
  while (world.matches.size() < options.matches) {
    Eigen::Vector3d point = VisiblePoint(random, camera, options.nearest, options.farthest);
    const bool on_plane = options.plane && Uniform(random, 0.0, 1.0) >= options.beside_plane;
    if (on_plane) point *= 6.0 / (point.z() * (1.0 + slope.dot(point / point.z())));
    const Eigen::Vector3d in_second = world.second_from_first * point;
    if (in_second.z() < 0.5 || !camera.Contains(camera.Project(in_second))) continue;
    PixelMatch match{camera.Project(point), camera.Project(in_second), 1.0 / std::max(options.noise, 0.1)};
    for (Eigen::Vector2d* pixel : {&match.first, &match.second}) {
      *pixel += options.noise * Eigen::Vector2d{Gauss(random), Gauss(random)};
    }
    const bool outlier = Uniform(random, 0.0, 1.0) < options.outlier_ratio;
    if (outlier) match.second = {Uniform(random, 0.0, camera.width), Uniform(random, 0.0, camera.height)};
    world.matches.push_back(match);
    world.points_in_first.push_back(point);
    world.is_outlier.push_back(outlier);
  }
  return world;
}

// Pixels of the second image from the true epipolar line.
double EpipolarDistance(const TwoViewWorld& world, const PixelMatch& match) {
  const IdealCamera camera = MonocularCamera();
  // Two points of the line.
  const Eigen::Vector2d a = camera.Project(world.second_from_first * (2.0 * camera.Unproject(match.first)));
  const Eigen::Vector2d b = camera.Project(world.second_from_first * (20.0 * camera.Unproject(match.first)));
  const Eigen::Vector2d along = (b - a).normalized();
  const Eigen::Vector2d off = match.second - a;
  return std::abs(along.x() * off.y() - along.y() * off.x());
}

struct MotionError {
  double turn = 0.0;       // degrees
  double direction = 0.0;  // of the translation, degrees
};

MotionError ErrorOf(const Rigid3d& motion, const Rigid3d& truth) {
  const double degrees = 180.0 / std::numbers::pi;
  return {degrees * LogSo3(motion.rotation() * truth.rotation().conjugate()).norm(),
          degrees * std::acos(std::clamp(motion.translation().normalized().dot(truth.translation().normalized()), -1.0,
                                         1.0))};
}

// Relative errors of the reconstructed depths, once the scale is taken out.
double MedianDepthError(const TwoViewReconstruction& found, const TwoViewWorld& world) {
  std::vector<double> ratios;
  for (const TwoViewPoint& point : found.points) {
    ratios.push_back(point.point_in_first.z() / world.points_in_first[point.match].z());
  }
  std::sort(ratios.begin(), ratios.end());
  const double scale = ratios[ratios.size() / 2];
  std::vector<double> errors;
  for (const double ratio : ratios) errors.push_back(std::abs(ratio / scale - 1.0));
  std::sort(errors.begin(), errors.end());
  return errors[errors.size() / 2];
}

void ExpectTrue(const TwoViewReconstruction& found, const TwoViewWorld& world, std::uint64_t seed) {
  const MotionError error = ErrorOf(found.second_from_first, world.second_from_first);
  EXPECT_LT(error.turn, 0.5) << "seed " << seed;
  EXPECT_LT(error.direction, 6.0) << "seed " << seed;
  EXPECT_LT(MedianDepthError(found, world), 0.05) << "seed " << seed;
  std::vector<double> depths;
  for (const TwoViewPoint& point : found.points) depths.push_back(point.point_in_first.z());
  std::nth_element(depths.begin(), depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2), depths.end());
  EXPECT_NEAR(depths[depths.size() / 2], 1.0, 1e-9);
}

TEST(TwoViewMotion, AGeneralSceneIsReconstructedByTheEssentialMatrix) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const TwoViewWorld world = MakeTwoViewWorld(seed, {.nearest = 2.0});
    const auto found = ReconstructFromTwoViews(MonocularCamera(), world.matches, {}, seed);
    ASSERT_TRUE(found) << "seed " << seed << ": " << ToString(found.error());
    EXPECT_FALSE(found->planar) << "seed " << seed;
    ExpectTrue(*found, world, seed);
  }
}

TEST(TwoViewMotion, APlaneIsReconstructedByTheHomographyOrRefusedAsAmbiguousButNeverWrong) {
  int found_count = 0;
  int planar_count = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const TwoViewWorld world = MakeTwoViewWorld(seed, {.plane = true, .step = {1.5, 0.3, 0.2}, .turn = 0.2});
    const auto found = ReconstructFromTwoViews(MonocularCamera(), world.matches, {}, seed);
    if (!found) {
      EXPECT_EQ(found.error(), TwoViewRefusal::kAmbiguous) << "seed " << seed;
      continue;
    }
    ++found_count;
    planar_count += found->planar ? 1 : 0;
    ExpectTrue(*found, world, seed);
  }
  EXPECT_GE(found_count, 10);
  // With noise one plane in a hundred looks as if it had depth.
  EXPECT_GE(planar_count, found_count - 2);
}

// Steps towards a wall while turning: both motions that a plane leaves possible see all of it in front of them.
int CountFoundAtAWall(double beside_plane) {
  int found_count = 0;
  for (std::uint64_t seed = 0; seed < 80; ++seed) {
    const TwoViewWorld world =
        MakeTwoViewWorld(seed, {.plane = true, .beside_plane = beside_plane, .step = {0.25, 0.05, 0.2}, .turn = 0.15});
    const auto found = ReconstructFromTwoViews(MonocularCamera(), world.matches, {}, seed);
    if (!found) {
      EXPECT_EQ(found.error(), TwoViewRefusal::kAmbiguous) << "seed " << seed;
      continue;
    }
    ++found_count;
    const MotionError error = ErrorOf(found->second_from_first, world.second_from_first);
    EXPECT_LT(error.turn, 1.0) << "seed " << seed;
    EXPECT_LT(error.direction, 20.0) << "seed " << seed;
  }
  return found_count;
}

TEST(TwoViewMotion, WhatStandsBesideAPlaneTellsItsTwoMotionsApart) {
  const int wall = CountFoundAtAWall(0.0);
  EXPECT_LE(wall, 68) << "too easy to show anything";
  EXPECT_GE(CountFoundAtAWall(0.15), 76);
}

TEST(TwoViewMotion, OfFortyPercentOutliersThoseAloneBecomePointsThatLieOnTheirEpipolarLines) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const TwoViewWorld world = MakeTwoViewWorld(seed, {.outlier_ratio = 0.4, .nearest = 2.0});
    const auto found = ReconstructFromTwoViews(MonocularCamera(), world.matches, {}, seed);
    ASSERT_TRUE(found) << "seed " << seed << ": " << ToString(found.error());
    ExpectTrue(*found, world, seed);
    int wrong = 0;
    for (const TwoViewPoint& point : found->points) {
      if (!world.is_outlier[point.match]) continue;
      ++wrong;
      // One that happens to lie on its epipolar line, as the motion that was found draws it, cannot be told from a
      // point.
      EXPECT_LT(EpipolarDistance(world, world.matches[point.match]), 15.0) << "seed " << seed;
    }
    EXPECT_LE(wrong, 4) << "seed " << seed;
  }
}

TEST(TwoViewMotion, MostSeedsLeadToTheSameStartBitByBit) {
  constexpr int kSeeds = 10;
  int same = 0;
  for (std::uint64_t place = 0; place < 20; ++place) {
    const TwoViewWorld world = MakeTwoViewWorld(place, {.outlier_ratio = 0.2, .nearest = 2.0});
    const auto first = ReconstructFromTwoViews(MonocularCamera(), world.matches, {}, 0);
    ASSERT_TRUE(first);
    for (std::uint64_t seed = 1; seed < kSeeds; ++seed) {
      const auto found = ReconstructFromTwoViews(MonocularCamera(), world.matches, {}, seed);
      ASSERT_TRUE(found);
      same += found->second_from_first.translation() == first->second_from_first.translation() &&
              found->points.size() == first->points.size();
    }
  }
  EXPECT_GE(same, 20 * (kSeeds - 1) * 8 / 10);
}

TEST(TwoViewMotion, APureRotationIsRefused) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const TwoViewWorld world = MakeTwoViewWorld(seed, {.step = Eigen::Vector3d::Zero(), .turn = 0.3});
    const auto found = ReconstructFromTwoViews(MonocularCamera(), world.matches, {}, seed);
    ASSERT_FALSE(found) << "seed " << seed;
    EXPECT_EQ(found.error(), TwoViewRefusal::kLowParallax) << "seed " << seed;
  }
}

TEST(TwoViewMotion, LowParallaxIsRefused) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const TwoViewWorld world = MakeTwoViewWorld(seed, {.step = {0.03, 0.01, 0.0}});
    EXPECT_FALSE(ReconstructFromTwoViews(MonocularCamera(), world.matches, {}, seed)) << "seed " << seed;
  }
}

TEST(TwoViewMotion, RandomMatchesAndTooFewAreRefused) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const TwoViewWorld world = MakeTwoViewWorld(seed, {.outlier_ratio = 1.0});
    EXPECT_FALSE(ReconstructFromTwoViews(MonocularCamera(), world.matches, {}, seed)) << "seed " << seed;
  }
  const TwoViewWorld world = MakeTwoViewWorld(1, {.matches = 40});
  const auto few = ReconstructFromTwoViews(MonocularCamera(), world.matches, {}, 1);
  ASSERT_FALSE(few);
  EXPECT_EQ(few.error(), TwoViewRefusal::kTooFewMatches);
  EXPECT_FALSE(ReconstructFromTwoViews(MonocularCamera(), {}, {}, 1));
}

TEST(TwoViewMotion, NonFiniteMatchesAreOutliers) {
  TwoViewWorld world = MakeTwoViewWorld(3, {.nearest = 2.0});
  for (std::size_t i = 0; i < 20; ++i) world.matches[i].second.x() = std::numeric_limits<double>::quiet_NaN();
  const auto found = ReconstructFromTwoViews(MonocularCamera(), world.matches, {}, 3);
  ASSERT_TRUE(found) << ToString(found.error());
  EXPECT_GE(found->points.front().match, 20U);
}

TEST(TwoViewMotion, TheSameSeedGivesTheSameAnswer) {
  const TwoViewWorld world = MakeTwoViewWorld(5, {.outlier_ratio = 0.3, .nearest = 2.0});
  const auto a = ReconstructFromTwoViews(MonocularCamera(), world.matches, {}, 42);
  const auto b = ReconstructFromTwoViews(MonocularCamera(), world.matches, {}, 42);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->second_from_first.Matrix(), b->second_from_first.Matrix());
  ASSERT_EQ(a->points.size(), b->points.size());
  for (std::size_t i = 0; i < a->points.size(); ++i) {
    EXPECT_EQ(a->points[i].match, b->points[i].match);
    EXPECT_EQ(a->points[i].point_in_first, b->points[i].point_in_first);
  }
}

TEST(TwoViewOptions, ANonsenseValueIsNamed) {
  EXPECT_TRUE(TwoViewOptions{}.Check());
  TwoViewOptions options;
  options.min_parallax = 0.0;
  const auto status = options.Check();
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("min_parallax"), std::string::npos);
}

}  // namespace
}  // namespace pangaea::testing
