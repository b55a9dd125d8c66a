#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <random>

#include "common/geometry/essential_matrix.h"
#include "common/geometry/five_point.h"
#include "common/geometry/homography.h"

namespace pangaea {
namespace {

// Points at z = 1 of both cameras.
struct Views {
  Rigid3d second_from_first;
  std::vector<Eigen::Vector2d> first;
  std::vector<Eigen::Vector2d> second;
};

Views MakeViews(std::uint64_t seed, bool plane, std::size_t points) {
  std::mt19937_64 random(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Views views;
  Vector6d twist;
  for (int k = 0; k < 6; ++k) twist(k) = uniform(-0.3, 0.3);
  views.second_from_first = Rigid3d::Exp(twist);
  // Braces, unlike parentheses, draw in order.
  const Eigen::Vector3d slope{uniform(-0.3, 0.3), uniform(-0.3, 0.3), 0.0};
  while (views.first.size() < points) {
    const Eigen::Vector2d ray{uniform(-0.8, 0.8), uniform(-0.5, 0.5)};
    const double depth = plane ? 4.0 / (1.0 + slope.dot(ray.homogeneous())) : uniform(2.0, 8.0);
    const Eigen::Vector3d in_second = views.second_from_first * (depth * ray.homogeneous());
    if (in_second.z() < 0.5) continue;
    views.first.push_back(ray);
    views.second.push_back(in_second.hnormalized());
  }
  return views;
}

// Translation directions and rotations compared; the scale is free.
double MotionDistance(const Rigid3d& a, const Rigid3d& b) {
  const Rigid3d unit_a(a.rotation(), a.translation().normalized());
  const Rigid3d unit_b(b.rotation(), b.translation().normalized());
  return (unit_a * unit_b.Inverse()).Log().norm();
}

double BestDistance(const std::vector<Rigid3d>& motions, const Rigid3d& truth) {
  double best = std::numeric_limits<double>::infinity();
  for (const Rigid3d& motion : motions) best = std::min(best, MotionDistance(motion, truth));
  return best;
}

TEST(Homography, OfAPlaneTakesEachPointToItsImageAndHidesTheTrueMotion) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Views views = MakeViews(seed, true, 4 + seed % 30);
    const auto homography = FitHomography(views.first, views.second);
    ASSERT_TRUE(homography) << seed;
    for (std::size_t i = 0; i < views.first.size(); ++i) {
      EXPECT_LT(((*homography * views.first[i].homogeneous()).hnormalized() - views.second[i]).norm(), 1e-6) << seed;
    }
    const auto motions = DecomposeHomography(*homography);
    EXPECT_EQ(motions.size(), 8U) << seed;
    EXPECT_LT(BestDistance(motions, views.second_from_first), 1e-5) << seed;
  }
}

TEST(Homography, OfAPureRotationHasNoMotion) {
  const Eigen::Matrix3d rotation =
      Rigid3d::Exp((Vector6d() << 0, 0, 0, 0.1, -0.2, 0.3).finished()).rotation().toRotationMatrix();
  EXPECT_TRUE(DecomposeHomography(2.0 * rotation).empty());
  EXPECT_TRUE(DecomposeHomography(Eigen::Matrix3d::Zero()).empty());
}

TEST(Homography, CollinearOrTooFewPointsDetermineNone) {
  std::vector<Eigen::Vector2d> line;
  for (int i = 0; i < 10; ++i) line.emplace_back(0.1 * i, 0.05 * i);
  EXPECT_FALSE(FitHomography(line, line));
  const std::vector<Eigen::Vector2d> same(6, Eigen::Vector2d(0.1, 0.2));
  EXPECT_FALSE(FitHomography(same, same));
  EXPECT_FALSE(FitHomography(std::span(line).first(3), std::span(line).first(3)));
}

TEST(EssentialMatrix, OfAGeneralSceneIsThatOfTheMotionAndHidesIt) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Views views = MakeViews(seed, false, 8 + seed % 30);
    const auto essential = FitEssentialMatrix(views.first, views.second);
    ASSERT_TRUE(essential) << seed;
    for (std::size_t i = 0; i < views.first.size(); ++i) {
      EXPECT_NEAR(views.second[i].homogeneous().dot(*essential * views.first[i].homogeneous()), 0.0, 1e-6) << seed;
    }
    const auto motions = DecomposeEssentialMatrix(*essential);
    EXPECT_EQ(motions.size(), 4U);
    EXPECT_LT(BestDistance(motions, views.second_from_first), 1e-4) << seed;
    EXPECT_LT(
        BestDistance(DecomposeEssentialMatrix(EssentialMatrixOf(views.second_from_first)), views.second_from_first),
        1e-9)
        << seed;
  }
}

TEST(EssentialMatrix, TooFewOrCoincidingPointsDetermineNone) {
  const Views views = MakeViews(1, false, 8);
  EXPECT_FALSE(FitEssentialMatrix(std::span(views.first).first(7), std::span(views.second).first(7)));
  const std::vector<Eigen::Vector2d> same(12, Eigen::Vector2d(0.1, 0.2));
  EXPECT_FALSE(FitEssentialMatrix(same, same));
}

TEST(FivePoint, TheTrueMotionIsAmongTheSolutionsForAnySceneAndEachSolutionExplainsThePoints) {
  int missed = 0;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    const Views views = MakeViews(seed, seed % 2 == 0, 5);
    double best = std::numeric_limits<double>::infinity();
    for (const Eigen::Matrix3d& essential : SolveFivePoint(views.first, views.second)) {
      best = std::min(best, BestDistance(DecomposeEssentialMatrix(essential), views.second_from_first));
      for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_NEAR(views.second[i].homogeneous().dot(essential * views.first[i].homogeneous()), 0.0, 1e-9) << seed;
      }
    }
    missed += best > 1e-4 ? 1 : 0;
  }
  // Near a double root the problem itself is ill-conditioned.
  EXPECT_LE(missed, 10);
}

TEST(FivePoint, CoincidingPointsDoNoHarmAndNonFiniteOnesHaveNoSolution) {
  const std::vector<Eigen::Vector2d> same(5, Eigen::Vector2d(0.1, 0.2));
  for (const Eigen::Matrix3d& essential : SolveFivePoint(same, same)) EXPECT_TRUE(essential.allFinite());
  std::vector<Eigen::Vector2d> broken = MakeViews(1, false, 5).first;
  broken[2].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(SolveFivePoint(broken, broken).empty());
}

}  // namespace
}  // namespace pangaea
