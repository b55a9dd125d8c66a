#include "common/geometry/ransac.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <set>

namespace pangaea {
namespace {

// Lines y = a x + b through points of which some are anywhere.
struct Line {
  double a = 0.0;
  double b = 0.0;
};

struct LineWorld {
  std::vector<Eigen::Vector2d> points;

  void Solve(std::span<const std::size_t> sample, std::vector<Line>& lines) const {
    const Eigen::Vector2d p = points[sample[0]];
    const Eigen::Vector2d q = points[sample[1]];
    if (p.x() == q.x()) return;
    const double a = (q.y() - p.y()) / (q.x() - p.x());
    lines.push_back({a, p.y() - a * p.x()});
  }
  RansacScore Score(const Line& line, std::span<std::uint8_t> inliers) const {
    RansacScore score{0.0, 0};
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double error = std::abs(points[i].y() - line.a * points[i].x() - line.b);
      inliers[i] = error < 0.1 ? 1 : 0;
      score.inliers += inliers[i];
      score.cost += std::min(error, 0.1);
    }
    return score;
  }
};

LineWorld MakeLineWorld(std::uint64_t seed, int inliers, int outliers) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-10.0, 10.0);
  LineWorld world;
  for (int i = 0; i < inliers; ++i) {
    const double x = uniform(random);
    world.points.emplace_back(x, 2.0 * x + 1.0);
  }
  for (int i = 0; i < outliers; ++i) {
    const double x = uniform(random);
    world.points.emplace_back(x, 3.0 * uniform(random));
  }
  return world;
}

std::optional<RansacResult<Line>> FitLine(const LineWorld& world, const RansacOptions& options, std::uint64_t seed) {
  return Ransac<Line>(
      world.points.size(), options, seed,
      [&](std::span<const std::size_t> sample, std::vector<Line>& lines) { world.Solve(sample, lines); },
      [&](const Line& line, std::span<std::uint8_t> inliers) { return world.Score(line, inliers); },
      [](const Line&, std::span<const std::uint8_t>) { return std::optional<Line>(); });
}

TEST(Ransac, FindsTheLineAmongSixtyPercentOutliers) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const LineWorld world = MakeLineWorld(seed, 40, 60);
    const auto result = FitLine(world, {.sample_size = 2}, seed);
    ASSERT_TRUE(result);
    EXPECT_NEAR(result->model.a, 2.0, 1e-9) << "seed " << seed;
    EXPECT_GE(result->score.inliers, 40U);
    for (int i = 0; i < 40; ++i) EXPECT_EQ(result->inliers[i], 1);
  }
}

TEST(Ransac, StopsEarlyWhenNearlyEverythingAgrees) {
  const auto clean = FitLine(MakeLineWorld(1, 100, 0), {.sample_size = 2}, 1);
  const auto dirty = FitLine(MakeLineWorld(1, 20, 80), {.sample_size = 2}, 1);
  ASSERT_TRUE(clean && dirty);
  EXPECT_EQ(clean->iterations, 1);
  EXPECT_GT(dirty->iterations, 20);
  EXPECT_LE(dirty->iterations, 300);
}

TEST(Ransac, DrawsAsManySamplesAsItIsToldAtLeastAndAtMost) {
  const LineWorld world = MakeLineWorld(1, 100, 0);
  const auto at_least = FitLine(world, {.sample_size = 2, .min_iterations = 20}, 1);
  const auto at_most = FitLine(world, {.sample_size = 2, .max_iterations = 5, .min_iterations = 20}, 1);
  ASSERT_TRUE(at_least && at_most);
  EXPECT_EQ(at_least->iterations, 20);
  EXPECT_EQ(at_most->iterations, 5);
}

TEST(Ransac, TheSeedDecidesEverything) {
  const LineWorld world = MakeLineWorld(2, 20, 80);
  const auto a = FitLine(world, {.sample_size = 2, .max_iterations = 5}, 7);
  const auto b = FitLine(world, {.sample_size = 2, .max_iterations = 5}, 7);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->model.a, b->model.a);
  EXPECT_EQ(a->inliers, b->inliers);
}

TEST(Ransac, TooFewDataAndUnsolvableSamplesGiveNothing) {
  LineWorld world;
  world.points = {{1.0, 1.0}};
  EXPECT_FALSE(FitLine(world, {.sample_size = 2}, 1));
  world.points = {{1.0, 1.0}, {1.0, 2.0}, {1.0, 3.0}};
  EXPECT_FALSE(FitLine(world, {.sample_size = 2}, 1));
}

TEST(SampleDrawer, DrawsDistinctIndicesAndReachesAll) {
  SampleDrawer drawer(6, 3);
  std::set<std::size_t> reached;
  for (int i = 0; i < 100; ++i) {
    const auto sample = drawer.Draw(3);
    EXPECT_EQ(std::set<std::size_t>(sample.begin(), sample.end()).size(), 3U);
    reached.insert(sample.begin(), sample.end());
  }
  EXPECT_EQ(reached.size(), 6U);
}

}  // namespace
}  // namespace pangaea
