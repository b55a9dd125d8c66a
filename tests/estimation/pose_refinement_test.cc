#include "common/estimation/pose_refinement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/estimation/pose_kernel.h"
#include "tests/estimation/synthetic_world.h"

namespace pangaea::testing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double PoseError(const Rigid3d& a, const Rigid3d& b) { return (a * b.Inverse()).Log().norm(); }

// Half the gradient, by central differences of the cost.
Vector6d NumericGradient(const PoseWorld& world, const Rigid3d& pose, const KernelBends& bends) {
  const std::vector<std::uint8_t> all(world.observations.size(), 1);
  Vector6d gradient;
  for (int k = 0; k < 6; ++k) {
    const double h = 1e-6;
    const Vector6d step = h * Vector6d::Unit(k);
    const auto cost = [&](const Vector6d& twist) {
      return AccumulatePose(world.camera, Rigid3d::Exp(twist) * pose, world.observations, all, bends).cost;
    };
    gradient(k) = 0.5 * (cost(step) - cost(-step)) / (2.0 * h);
  }
  return gradient;
}

TEST(PoseKernel, AnalyticGradientIsTheNumericOne) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const PoseWorld world = MakePoseWorld(seed, {.observations = 37, .noise = 2.0, .outlier_ratio = 0.2});
    const std::vector<std::uint8_t> all(world.observations.size(), 1);
    for (const KernelBends& bends : {KernelBends{kMonocularChi2, kStereoChi2}, KernelBends{0.1, 0.13}, kNoKernel}) {
      const PoseNormalEquations equations =
          AccumulatePose(world.camera, world.camera_from_map, world.observations, all, bends);
      const Vector6d numeric = NumericGradient(world, world.camera_from_map, bends);
      EXPECT_LT((equations.gradient - numeric).norm(), 1e-4 * numeric.norm()) << "seed " << seed;
    }
  }
}

class PoseKernelOfSize : public ::testing::TestWithParam<std::size_t> {};

TEST_P(PoseKernelOfSize, InformationIsThatOfTheReprojectionJacobians) {
  const PoseWorld world = MakePoseWorld(3, {.observations = GetParam(), .noise = 1.0});
  Matrix6d expected = Matrix6d::Zero();
  for (const PoseObservation& observation : world.observations) {
    const Eigen::Vector3d point = world.camera_from_map * observation.point_in_map;
    const Eigen::Matrix<double, 3, 6> jacobian =
        observation.inverse_sigma * ReprojectionJacobian(world.camera, point, IsStereo(observation.measurement)) *
        PerturbationJacobian(point);
    expected += jacobian.transpose() * jacobian;
  }
  const std::vector<std::uint8_t> all(world.observations.size(), 1);
  const PoseNormalEquations equations =
      AccumulatePose(world.camera, world.camera_from_map, world.observations, all, {1e300, 1e300});
  EXPECT_LE((equations.information - expected).norm(), 1e-12 * expected.norm());
}

INSTANTIATE_TEST_SUITE_P(AroundTheVectorWidth, PoseKernelOfSize, ::testing::Values(0, 1, 3, 7, 8, 9, 21));

double SquaredPoseError(const PoseWorld& world, const PoseRefinementOptions& options) {
  std::vector<std::uint8_t> inliers(world.observations.size());
  const auto pose = RefinePose(world.camera, world.camera_from_map, world.observations, options, inliers);
  return std::pow(PoseError(pose.value().camera_from_map, world.camera_from_map), 2);
}

TEST(PoseRefinement, ExactObservationsGiveTheExactPose) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    for (const bool stereo : {true, false}) {
      const PoseWorld world = MakePoseWorld(seed, {.observations = 50, .stereo = stereo});
      Random random(seed + 1000);
      const Rigid3d initial = Perturbed(random, world.camera_from_map, 0.2, 0.1);
      std::vector<std::uint8_t> inliers(world.observations.size());
      const auto pose = RefinePose(world.camera, initial, world.observations, {}, inliers);
      ASSERT_TRUE(pose) << "seed " << seed;
      EXPECT_LT(PoseError(pose->camera_from_map, world.camera_from_map), 1e-7);
      EXPECT_EQ(pose->inliers, 50);
      EXPECT_TRUE(pose->converged);
    }
  }
}

TEST(PoseRefinement, FortyPercentOutliersAreFoundAndDoNotMoveThePose) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const PoseWorld world = MakePoseWorld(seed, {.noise = 0.5, .outlier_ratio = 0.4});
    Random random(seed + 1000);
    const Rigid3d initial = Perturbed(random, world.camera_from_map, 0.05, 0.03);
    std::vector<std::uint8_t> inliers(world.observations.size());
    const auto pose = RefinePose(world.camera, initial, world.observations, {}, inliers);
    ASSERT_TRUE(pose) << "seed " << seed;
    EXPECT_LT(PoseError(pose->camera_from_map, world.camera_from_map), 0.02) << "seed " << seed;
    int wrong = 0;
    for (std::size_t i = 0; i < inliers.size(); ++i) wrong += inliers[i] == world.is_outlier[i] ? 1 : 0;
    EXPECT_LE(wrong, 6) << "seed " << seed;
  }
}

TEST(PoseRefinement, ErrorsAreAsLargeAsTheInformationSays) {
  double normalised = 0.0;
  const int worlds = 200;
  for (int seed = 0; seed < worlds; ++seed) {
    const PoseWorld world = MakePoseWorld(seed, {.observations = 100, .noise = 1.0});
    std::vector<std::uint8_t> inliers(world.observations.size());
    PoseRefinementOptions options;
    options.monocular_chi2 = options.stereo_chi2 = 100.0;
    options.narrow_share = kInfinity;
    const auto pose = RefinePose(world.camera, world.camera_from_map, world.observations, options, inliers);
    ASSERT_TRUE(pose);
    const Vector6d error = (pose->camera_from_map * world.camera_from_map.Inverse()).Log();
    normalised += error.dot(pose->information * error) / worlds;
  }
  // Six degrees of freedom: the mean of 200 such values has a standard deviation of 0.25.
  EXPECT_NEAR(normalised, 6.0, 1.0);
}

TEST(PoseRefinement, AFewPoorMeasurementsAmongGoodOnesMoveThePoseLessThanWithLeastSquares) {
  double narrow = 0.0;
  double least_squares = 0.0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    PoseWorld world = MakePoseWorld(seed, {});
    Random random(seed + 1000);
    for (std::size_t i = 0; i < world.observations.size(); ++i) DisturbUnevenly(random, i, world.observations[i]);
    narrow += SquaredPoseError(world, {});
    least_squares += SquaredPoseError(world, {.narrow_share = kInfinity});
  }
  EXPECT_LT(narrow, 0.4 * least_squares);
}

TEST(PoseRefinement, NonFiniteAndHugeObservationsAreOutliers) {
  PoseWorld world = MakePoseWorld(5, {.observations = 60});
  world.observations[0].measurement.x() = kNaN;
  world.observations[1].measurement.z() = kNaN;
  world.observations[2].point_in_map.y() = kInfinity;
  world.observations[3].inverse_sigma = 0.0;
  world.observations[4].inverse_sigma = kNaN;
  world.observations[5].point_in_map.x() = 1e300;
  std::vector<std::uint8_t> inliers(world.observations.size(), 1);
  const auto pose = RefinePose(world.camera, world.camera_from_map, world.observations, {}, inliers);
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->inliers, 54);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(inliers[i], 0) << i;
  EXPECT_LT(PoseError(pose->camera_from_map, world.camera_from_map), 1e-7);
}

TEST(PoseRefinement, ThereIsNoPoseFromBadInput) {
  const PoseWorld world = MakePoseWorld(6, {.observations = 30});
  std::vector<std::uint8_t> inliers(30, 1);
  const Rigid3d bad(Eigen::Quaterniond(kNaN, 0.0, 0.0, 0.0), Eigen::Vector3d::Zero());
  EXPECT_FALSE(RefinePose(world.camera, bad, world.observations, {}, inliers));
  EXPECT_EQ(std::count(inliers.begin(), inliers.end(), 0), 30);
  const std::span<const PoseObservation> few(world.observations.data(), 5);
  EXPECT_FALSE(RefinePose(world.camera, world.camera_from_map, few, {}, std::span(inliers).first(5)));
  EXPECT_FALSE(RefinePose(world.camera, world.camera_from_map, {}, {}, {}));
}

TEST(PoseRefinement, ThereIsNoPoseFromOnePointSeenOftenOrFromALineOfPoints) {
  PoseWorld world = MakePoseWorld(7, {.observations = 30, .stereo = false});
  std::vector<std::uint8_t> inliers(30);
  std::vector<PoseObservation> same(30, world.observations[0]);
  EXPECT_FALSE(RefinePose(world.camera, world.camera_from_map, same, {}, inliers));

  const Rigid3d map_from_camera = world.camera_from_map.Inverse();
  for (int i = 0; i < 30; ++i) {
    const Eigen::Vector3d point(0.1 * i - 1.5, 0.0, 5.0);
    world.observations[i].point_in_map = map_from_camera * point;
    world.observations[i].measurement = Measure(world.camera, point);
  }
  EXPECT_FALSE(RefinePose(world.camera, world.camera_from_map, world.observations, {}, inliers));
}

TEST(PoseRefinement, PointsBehindTheCameraAreOutliers) {
  PoseWorld world = MakePoseWorld(8, {.observations = 40});
  const Rigid3d map_from_camera = world.camera_from_map.Inverse();
  for (int i = 0; i < 5; ++i) {
    const Eigen::Vector3d point = world.camera_from_map * world.observations[i].point_in_map;
    world.observations[i].point_in_map = map_from_camera * (-point);  // the same pixel, from behind
  }
  std::vector<std::uint8_t> inliers(40);
  const auto pose = RefinePose(world.camera, world.camera_from_map, world.observations, {}, inliers);
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->inliers, 35);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(inliers[i], 0) << i;
}

TEST(PoseRefinement, AStrongPriorHoldsThePoseAndAWeakOneDoesNot) {
  const PoseWorld world = MakePoseWorld(9, {.observations = 40});
  Random random(10);
  PosePrior prior{Perturbed(random, world.camera_from_map, 0.005, 0.002), 1e12 * Matrix6d::Identity()};
  PoseRefinementOptions options;
  options.monocular_chi2 = options.stereo_chi2 = 1e4;
  std::vector<std::uint8_t> inliers(40);
  const auto held = RefinePose(world.camera, world.camera_from_map, world.observations, options, inliers, prior);
  ASSERT_TRUE(held);
  EXPECT_LT(PoseError(held->camera_from_map, prior.camera_from_map), 1e-4);
  prior.information = 1e-6 * Matrix6d::Identity();
  const auto free = RefinePose(world.camera, prior.camera_from_map, world.observations, options, inliers, prior);
  ASSERT_TRUE(free);
  EXPECT_LT(PoseError(free->camera_from_map, world.camera_from_map), 1e-6);
}

TEST(PoseRefinement, APriorCanReplaceMissingObservations) {
  PoseWorld world = MakePoseWorld(11, {.observations = 2});
  PoseRefinementOptions options;
  options.min_inliers = 2;
  std::vector<std::uint8_t> inliers(2);
  world.observations.resize(2);
  world.observations[0].measurement.z() = world.observations[1].measurement.z() = -1.0;
  EXPECT_FALSE(RefinePose(world.camera, world.camera_from_map, world.observations, options, inliers));
  const PosePrior prior{world.camera_from_map, Matrix6d::Identity()};
  EXPECT_TRUE(RefinePose(world.camera, world.camera_from_map, world.observations, options, inliers, prior));
}

TEST(Observability, DistantPointsLeaveTheTranslationUncertain) {
  const auto largest_sigma = [](double nearest, double farthest) {
    const PoseWorld world =
        MakePoseWorld(12, {.observations = 100, .stereo = false, .nearest = nearest, .farthest = farthest});
    std::vector<std::uint8_t> inliers(100);
    const auto pose = RefinePose(world.camera, world.camera_from_map, world.observations, {}, inliers);
    return TranslationSigmas(pose.value().information).maxCoeff();
  };
  const double near = largest_sigma(1.0, 3.0);
  const double far = largest_sigma(100.0, 300.0);
  EXPECT_LT(near, 0.01);
  // Uncertainty grows in proportion to distance.
  EXPECT_NEAR(far / near, 100.0, 1.0);
}

TEST(Observability, WithoutInformationTheSigmasAreInfinite) {
  EXPECT_EQ(TranslationSigmas(Matrix6d::Zero()), Eigen::Vector3d::Constant(kInfinity));
  Matrix6d diagonal = Matrix6d::Identity();
  diagonal(0, 0) = 4.0;
  EXPECT_DOUBLE_EQ(TranslationSigmas(diagonal).x(), 0.5);
}

TEST(PoseRefinementOptions, ImpossibleValuesAreRefused) {
  EXPECT_TRUE(PoseRefinementOptions{}.Check());
  PoseRefinementOptions options;
  options.rounds_with_narrow_kernel = 5;
  EXPECT_FALSE(options.Check());
  options = {};
  options.stereo_chi2 = kNaN;
  EXPECT_FALSE(options.Check());
  options = {};
  options.narrow_share = 0.0;
  EXPECT_FALSE(options.Check());
}

}  // namespace
}  // namespace pangaea::testing
