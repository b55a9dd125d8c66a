#include "common/estimation/bundle_adjustment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "tests/estimation/synthetic_world.h"

namespace pangaea::testing {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr BundleSolver kSolvers[] = {BundleSolver::kLocal, BundleSolver::kSparse, BundleSolver::kDenseSchur,
                                     BundleSolver::kSparseSchur, BundleSolver::kIterativeSchur};

BundleOptions Thorough(BundleSolver solver) {
  BundleOptions options;
  options.solver = solver;
  options.iterations = 60;
  options.cost_tolerance = 1e-12;
  return options;
}

double LargestPoseError(const BundleProblem& truth, const BundleResult& result) {
  double largest = 0.0;
  for (std::size_t i = 0; i < truth.poses.size(); ++i) {
    const Vector6d error = (result.poses[i] * truth.poses[i].camera_from_map.Inverse()).Log();
    largest = std::max(largest, error.norm());
  }
  return largest;
}

TEST(BundleAdjustment, ExactObservationsGiveTheExactWorld) {
  for (const BundleSolver solver : kSolvers) {
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      const BundleWorld world = MakeBundleWorld(seed, {.noise = 0.0, .stereo = seed % 2 == 0});
      const auto result = SolveBundle(world.problem, Thorough(solver));
      ASSERT_TRUE(result);
      EXPECT_LT(result->final_cost, 1e-8);
      EXPECT_LT(LargestPoseError(world.truth, *result), 1e-5) << "seed " << seed;
    }
  }
}

TEST(BundleAdjustment, AllSolversReachTheSameCostAmongOutliers) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const BundleWorld world = MakeBundleWorld(seed, {.outlier_ratio = 0.1, .stereo = seed % 2 == 0});
    const auto own = SolveBundle(world.problem, Thorough(BundleSolver::kLocal));
    ASSERT_TRUE(own);
    EXPECT_LT(own->final_cost, own->initial_cost);
    for (const BundleSolver solver : {BundleSolver::kSparse, BundleSolver::kDenseSchur, BundleSolver::kSparseSchur}) {
      const auto other = SolveBundle(world.problem, Thorough(solver));
      ASSERT_TRUE(other);
      EXPECT_NEAR(own->initial_cost, other->initial_cost, 1e-9 * other->initial_cost) << "seed " << seed;
      EXPECT_NEAR(own->final_cost, other->final_cost, 1e-6 * other->final_cost) << "seed " << seed;
    }
  }
}

BundleWorld MakeUnevenWorld(std::uint64_t seed) {
  BundleWorld world = MakeBundleWorld(seed, {.noise = 0.0, .stereo = seed % 2 == 0});
  Random random(seed + 1000);
  std::size_t index = 0;
  for (BundleObservation& observation : world.problem.observations) DisturbUnevenly(random, index++, observation);
  return world;
}

TEST(BundleAdjustment, AFewPoorMeasurementsAmongGoodOnesMoveItLessThanWithLeastSquares) {
  for (const BundleSolver solver : {BundleSolver::kLocal, BundleSolver::kSparse, BundleSolver::kDenseSchur}) {
    double narrow = 0.0;
    double least_squares = 0.0;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const BundleWorld world = MakeUnevenWorld(seed);
      BundleOptions options = Thorough(solver);
      options.iterations_without_outliers = 60;
      const auto narrowed = SolveBundle(world.problem, options);
      options.narrow_share = kInfinity;
      const auto plain = SolveBundle(world.problem, options);
      ASSERT_TRUE(narrowed && plain);
      narrow += std::pow(LargestPoseError(world.truth, *narrowed), 2);
      least_squares += std::pow(LargestPoseError(world.truth, *plain), 2);
    }
    EXPECT_LT(narrow, 0.5 * least_squares) << "solver " << static_cast<int>(solver);
  }
}

// What a map shows of its noise decides, not by how much its sigmas are too large.
TEST(BundleAdjustment, TheNarrowKernelFollowsTheNoise) {
  const BundleWorld world = MakeUnevenWorld(3);
  const auto adjusted = [&world](double excess, double least_noise) {
    BundleProblem problem = world.problem;
    for (BundleObservation& observation : problem.observations) observation.inverse_sigma /= excess;
    BundleOptions options = Thorough(BundleSolver::kLocal);
    options.monocular_chi2 = options.stereo_chi2 = 1e6;  // the first phase is the same, too
    options.narrow_share = 1e-3;
    options.iterations_without_outliers = 200;
    options.least_noise = least_noise;
    return SolveBundle(problem, options).value();
  };
  const auto difference = [](const BundleResult& a, const BundleResult& b) {
    return (a.poses[0] * b.poses[0].Inverse()).Log().norm();
  };
  EXPECT_LT(difference(adjusted(4.0, 1e-6), adjusted(16.0, 1e-6)), 1e-7);
  EXPECT_GT(difference(adjusted(4.0, 1.0), adjusted(4.0, 1e-6)), 1e-5);
}

TEST(BundleAdjustment, AllSolversReachTheSameCostWithTheNarrowKernel) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const BundleWorld world = MakeUnevenWorld(seed);
    const auto cost = [&world](BundleSolver solver) {
      BundleOptions options = Thorough(solver);
      options.iterations_without_outliers = 200;
      const auto result = SolveBundle(world.problem, options);
      return result ? result->final_cost : -1.0;
    };
    const double own = cost(BundleSolver::kLocal);
    for (const BundleSolver solver : {BundleSolver::kSparse, BundleSolver::kDenseSchur, BundleSolver::kSparseSchur}) {
      EXPECT_NEAR(own, cost(solver), 1e-5 * own) << "seed " << seed;
    }
  }
}

TEST(BundleAdjustment, FortyPercentOutliersAreFoundAndTheSecondPhaseForgetsThem) {
  for (const BundleSolver solver : {BundleSolver::kLocal, BundleSolver::kSparse, BundleSolver::kDenseSchur}) {
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      const BundleWorld world = MakeBundleWorld(seed, {.noise = 0.5, .outlier_ratio = 0.4, .min_views = 7});
      BundleOptions options = Thorough(solver);
      options.iterations_without_outliers = 20;
      const auto result = SolveBundle(world.problem, options);
      ASSERT_TRUE(result);
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < world.is_outlier.size(); ++i) {
        wrong += result->outliers[i] != world.is_outlier[i] ? 1 : 0;
      }
      // Points of which most views are outliers cannot be told apart from good ones.
      EXPECT_LT(20 * wrong, world.is_outlier.size()) << "seed " << seed;
      EXPECT_LT(LargestPoseError(world.truth, *result), 0.02) << "seed " << seed;
    }
  }
}

TEST(BundleAdjustment, WhatIsFixedStaysBitIdentical) {
  for (const BundleSolver solver : kSolvers) {
    BundleWorld world = MakeBundleWorld(1, {});
    for (std::size_t i = 0; i < 20; ++i) world.problem.points[i].fixed = true;
    world.problem.points.push_back({{1.0, 2.0, 3.0}, false});  // seen by nobody
    const auto result = SolveBundle(world.problem, Thorough(solver));
    ASSERT_TRUE(result);
    for (std::size_t i = 0; i < world.problem.poses.size(); ++i) {
      const BundlePose& pose = world.problem.poses[i];
      const bool same = result->poses[i].Matrix() == pose.camera_from_map.Matrix();
      EXPECT_EQ(same, pose.fixed) << i;
    }
    for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(result->points[i], world.problem.points[i].point_in_map);
    EXPECT_NE(result->points[20], world.problem.points[20].point_in_map);
    EXPECT_EQ(result->points.back(), Eigen::Vector3d(1.0, 2.0, 3.0));
  }
}

TEST(BundleAdjustment, OneFixedPoseIsGaugeEnough) {
  const BundleWorld world = MakeBundleWorld(2, {.free_poses = 6, .fixed_poses = 1, .noise = 0.0});
  const auto result = SolveBundle(world.problem, Thorough(BundleSolver::kLocal));
  ASSERT_TRUE(result);
  EXPECT_LT(LargestPoseError(world.truth, *result), 1e-5);
}

TEST(BundleAdjustment, AllPosesFixedTriangulatesAndAllPointsFixedResects) {
  for (const BundleSolver solver : {BundleSolver::kLocal, BundleSolver::kDenseSchur}) {
    BundleWorld world = MakeBundleWorld(3, {.free_poses = 0, .fixed_poses = 6, .points = 50, .noise = 0.0});
    const auto points = SolveBundle(world.problem, Thorough(solver));
    ASSERT_TRUE(points);
    EXPECT_LT(points->final_cost, 1e-8);

    world = MakeBundleWorld(4, {.free_poses = 4, .fixed_poses = 0, .points = 80, .noise = 0.0, .point_error = 0.0});
    for (BundlePoint& point : world.problem.points) point.fixed = true;
    const auto poses = SolveBundle(world.problem, Thorough(solver));
    ASSERT_TRUE(poses);
    EXPECT_LT(LargestPoseError(world.truth, *poses), 1e-5);
  }
}

TEST(BundleAdjustment, APointSeenTwiceByOnePoseCountsTwice) {
  BundleWorld world = MakeBundleWorld(5, {.points = 60});
  const std::size_t count = world.problem.observations.size();
  for (std::size_t i = 0; i < count; i += 3) {
    BundleObservation again = world.problem.observations[i];
    again.measurement.x() += 1.0;
    world.problem.observations.push_back(again);
  }
  const auto own = SolveBundle(world.problem, Thorough(BundleSolver::kLocal));
  const auto ceres = SolveBundle(world.problem, Thorough(BundleSolver::kDenseSchur));
  ASSERT_TRUE(own && ceres);
  EXPECT_NEAR(own->final_cost, ceres->final_cost, 1e-6 * ceres->final_cost);
  // Wrong normal equations would need far more steps.
  EXPECT_LT(own->iterations, 25);
}

TEST(BundleAdjustment, PointsBehindACameraOrWithoutDepthDoNoHarm) {
  BundleWorld world = MakeBundleWorld(6, {.noise = 0.0});
  const int behind = static_cast<int>(world.problem.points.size());
  world.problem.points.push_back({{1.0, 0.0, -5.0}, false});
  world.problem.observations.push_back({0, behind, {300.0, 200.0, -1.0}, 1.0});
  world.problem.points.push_back({{1.0, 0.0, 5.0}, false});
  world.problem.observations.push_back({0, behind + 1, {300.0, 200.0, -1.0}, 1.0});
  for (const BundleSolver solver : {BundleSolver::kLocal, BundleSolver::kDenseSchur}) {
    const auto result = SolveBundle(world.problem, Thorough(solver));
    ASSERT_TRUE(result);
    EXPECT_EQ(result->outliers[result->outliers.size() - 2], 1);
    EXPECT_EQ(result->points[behind], Eigen::Vector3d(1.0, 0.0, -5.0));
    EXPECT_LT(LargestPoseError(world.truth, *result), 1e-5);
  }
}

TEST(BundleAdjustment, ARequestToStopReturnsTheBestSoFar) {
  const BundleWorld world = MakeBundleWorld(7, {});
  for (const BundleSolver solver : {BundleSolver::kLocal, BundleSolver::kDenseSchur}) {
    std::stop_source source;
    source.request_stop();
    BundleOptions options = Thorough(solver);
    options.iterations_without_outliers = 10;
    options.stop = source.get_token();
    const auto result = SolveBundle(world.problem, options);
    ASSERT_TRUE(result);
    EXPECT_TRUE(result->cancelled);
    EXPECT_EQ(result->iterations, 1);
    EXPECT_LT(result->final_cost, result->initial_cost);
  }
}

TEST(BundleAdjustment, TheSparseSolverGivesUpALongStepWhenAStopIsRequested) {
  const BundleWorld world = MakeBundleWorld(7, {});
  std::stop_source source;
  source.request_stop();
  BundleOptions options = Thorough(BundleSolver::kSparse);
  options.stop = source.get_token();
  const auto result = SolveBundle(world.problem, options);
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->cancelled);
  EXPECT_EQ(result->final_cost, result->initial_cost);
  for (std::size_t i = 0; i < result->poses.size(); ++i) {
    EXPECT_EQ(result->poses[i].translation(), world.problem.poses[i].camera_from_map.translation());
  }
}

TEST(BundleAdjustment, MalformedProblemsAreRefusedWithAReason) {
  const auto error_of = [](void (*spoil)(BundleProblem&)) {
    BundleProblem problem = MakeBundleWorld(8, {.points = 20}).problem;
    spoil(problem);
    const auto result = SolveBundle(problem, {});
    return result ? std::string() : result.error().message;
  };
  EXPECT_EQ(error_of([](BundleProblem&) {}), "");
  EXPECT_NE(error_of([](BundleProblem& p) { p.observations[3].measurement.x() = kNaN; }), "");
  EXPECT_NE(error_of([](BundleProblem& p) { p.observations[3].inverse_sigma = -1.0; }), "");
  EXPECT_NE(error_of([](BundleProblem& p) { p.observations[3].pose = 99; }), "");
  EXPECT_NE(error_of([](BundleProblem& p) { p.observations[3].point = -1; }), "");
  EXPECT_NE(error_of([](BundleProblem& p) { p.points[0].point_in_map.y() = kNaN; }), "");
  EXPECT_NE(error_of([](BundleProblem& p) { p.poses[0].camera = 1; }), "");
  EXPECT_NE(error_of([](BundleProblem& p) { p.cameras[0].focal_x = 0.0; }), "");
  EXPECT_NE(error_of([](BundleProblem& p) {
              for (BundlePose& pose : p.poses) pose.fixed = false;
            }),
            "");
  BundleOptions options;
  options.threads = 0;
  EXPECT_FALSE(SolveBundle(MakeBundleWorld(8, {}).problem, options));
  options = {};
  options.narrow_share = 0.0;
  EXPECT_FALSE(SolveBundle(MakeBundleWorld(8, {}).problem, options));
}

TEST(BundleAdjustment, AnEmptyProblemIsSolved) {
  BundleProblem problem;
  problem.cameras = {StereoCamera()};
  problem.poses = {{Rigid3d(), 0, true}};
  for (const BundleSolver solver : kSolvers) {
    const auto result = SolveBundle(problem, Thorough(solver));
    ASSERT_TRUE(result);
    EXPECT_EQ(result->final_cost, 0.0);
    EXPECT_EQ(result->poses.size(), 1U);
  }
}

TEST(BundleAdjustment, TheSameProblemGivesTheSameBits) {
  const BundleWorld world = MakeBundleWorld(9, {.outlier_ratio = 0.1});
  const auto a = SolveBundle(world.problem, {});
  const auto b = SolveBundle(world.problem, {});
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->final_cost, b->final_cost);
  for (std::size_t i = 0; i < a->points.size(); ++i) EXPECT_EQ(a->points[i], b->points[i]);
}

TEST(StartFrom, TakesASolutionOverWhereItIsWithinBounds) {
  BundleWorld world = MakeBundleWorld(1, {});
  BundleResult solution;
  for (const BundlePose& pose : world.truth.poses) solution.poses.push_back(pose.camera_from_map);
  for (const BundlePoint& point : world.truth.points) solution.points.push_back(point.point_in_map);
  solution.points.emplace_back(0.0, 0.0, 1.0);  // of a problem with more points
  solution.points[3].x() = std::numeric_limits<double>::infinity();
  solution.points[4].y() = 1e9;
  const BundleProblem before = world.problem;
  StartFrom(solution, world.problem);
  EXPECT_EQ(world.problem.poses[0].camera_from_map.translation(), world.truth.poses[0].camera_from_map.translation());
  EXPECT_EQ(world.problem.points[0].point_in_map, world.truth.points[0].point_in_map);
  EXPECT_EQ(world.problem.points[3].point_in_map, before.points[3].point_in_map);
  EXPECT_EQ(world.problem.points[4].point_in_map, before.points[4].point_in_map);
  EXPECT_TRUE(SolveBundle(world.problem, {}));
}

}  // namespace
}  // namespace pangaea::testing
