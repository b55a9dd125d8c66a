#include "common/estimation/similarity_refinement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "common/estimation/similarity_kernel.h"
#include "tests/estimation/synthetic_world.h"

namespace pangaea::testing {
namespace {

struct SimilarityWorld {
  Similarity3d target_from_source;
  std::vector<SightingPair> pairs;
  std::vector<std::uint8_t> is_outlier;
};

struct SimilarityWorldOptions {
  std::size_t pairs = 150;
  double scale = 1.0;
  double noise = 0.0;  // pixels
  double outlier_ratio = 0.0;
  bool stereo_source = true;
  bool stereo_target = true;
};

Sighting See(Random& random, const Eigen::Vector3d& point_in_camera, const Rigid3d& camera_from_side, double unit,
             bool stereo, double noise) {
  Sighting sighting;
  sighting.camera = stereo ? StereoCamera() : MonocularCamera();
  sighting.measurement = Measure(sighting.camera, point_in_camera);
  if (sighting.measurement.z() < 0.0) sighting.measurement.z() = -1.0;
  const bool has_right = IsStereo(sighting.measurement);
  sighting.measurement = Disturbed(random, sighting.measurement, noise);
  if (!has_right) sighting.measurement.z() = -1.0;
  sighting.inverse_sigma = noise > 0.0 ? 1.0 / noise : 1.0;
  // Lengths of the side are `unit` metres.
  sighting.camera_from_side = Rigid3d(camera_from_side.rotation(), camera_from_side.translation() / unit);
  sighting.camera.baseline /= unit;
  sighting.point = sighting.camera_from_side.Inverse() * (point_in_camera / unit);
  return sighting;
}

// Two cameras beside each other look at one cloud of points; the frames of the sides are elsewhere.
SimilarityWorld MakeWorld(std::uint64_t seed, const SimilarityWorldOptions& options) {
  Random random(seed);
  SimilarityWorld world;
  const Rigid3d target_camera_from_source_camera = Perturbed(random, Rigid3d(), 0.5, 0.15);
  const Rigid3d source_camera_from_side = Perturbed(random, Rigid3d(), 2.0, 1.0);
  const Rigid3d target_camera_from_side = Perturbed(random, Rigid3d(), 2.0, 1.0);
  const Rigid3d metric = target_camera_from_side.Inverse() * target_camera_from_source_camera * source_camera_from_side;
  // The source's lengths are options.scale metres: it is the side without a scale of its own.
  world.target_from_source = Similarity3d(options.scale, metric.rotation(), metric.translation());
  while (world.pairs.size() < options.pairs) {
    const Eigen::Vector3d in_source = VisiblePoint(random, StereoCamera(), 1.0, 10.0);
    const Eigen::Vector3d in_target = target_camera_from_source_camera * in_source;
    if (in_target.z() < 0.5 || !StereoCamera().Contains(StereoCamera().Project(in_target))) continue;
    SightingPair pair{
        .source = See(random, in_source, source_camera_from_side, options.scale, options.stereo_source, options.noise),
        .target = See(random, in_target, target_camera_from_side, 1.0, options.stereo_target, options.noise)};
    const bool outlier = Uniform(random, 0.0, 1.0) < options.outlier_ratio;
    if (outlier) pair.target.point += UniformVector(random, 1.0).normalized() * 2.0;
    world.pairs.push_back(pair);
    world.is_outlier.push_back(outlier ? 1 : 0);
  }
  return world;
}

Vector7d Disturbance(Random& random, double size, bool with_scale) {
  Vector7d e;
  e << UniformVector(random, size), UniformVector(random, size), with_scale ? Uniform(random, -size, size) : 0.0;
  return e;
}

double Distance(const Similarity3d& a, const Similarity3d& b) {
  const Similarity3d difference = a * b.Inverse();
  return difference.translation().norm() + LogSo3(difference.rotation()).norm() +
         std::abs(std::log(difference.scale()));
}

TEST(SimilarityRefinement, GradientAndInformationAreTheNumericOnes) {
  const double none = std::numeric_limits<double>::infinity();
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const SimilarityWorld world =
        MakeWorld(seed, {.pairs = 7, .scale = 0.6, .stereo_source = false, .stereo_target = seed % 2 == 0});
    Random random(seed);
    const Similarity3d at = Perturb(Disturbance(random, 0.02, true), world.target_from_source);
    const std::vector<std::uint8_t> active(world.pairs.size(), 1);
    for (const double bend : {4.0, none}) {
      const auto equations = AccumulateSimilarity(world.pairs, active, at, bend, bend);
      const double h = 1e-6;
      for (int k = 0; k < 7; ++k) {
        const Vector7d step = h * Vector7d::Unit(k);
        const Vector7d back = -step;
        const auto above = AccumulateSimilarity(world.pairs, active, Perturb(step, at), bend, bend);
        const auto below = AccumulateSimilarity(world.pairs, active, Perturb(back, at), bend, bend);
        const double numeric = (above.cost - below.cost) / (4.0 * h);
        EXPECT_NEAR(equations.gradient(k), numeric, 1e-4 * (1.0 + equations.gradient.norm())) << seed << " " << k;
      }
    }
    // At the truth the errors vanish, so that the Gauss-Newton information is the derivative of the gradient.
    const auto equations = AccumulateSimilarity(world.pairs, active, world.target_from_source, none, none);
    const double h = 1e-6;
    for (int k = 0; k < 7; ++k) {
      const Vector7d step = h * Vector7d::Unit(k);
      const Vector7d back = -step;
      const Vector7d numeric =
          (AccumulateSimilarity(world.pairs, active, Perturb(step, world.target_from_source), none, none).gradient -
           AccumulateSimilarity(world.pairs, active, Perturb(back, world.target_from_source), none, none).gradient) /
          (2.0 * h);
      EXPECT_LT((equations.information.col(k) - numeric).norm(), 1e-4 * equations.information.col(k).norm())
          << seed << " " << k;
    }
  }
}

TEST(SimilarityRefinement, FindsTheMotionAndTheScaleThatWerePlanted) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    for (const double scale : {1.0, 0.4, 3.0}) {
      const bool with_scale = scale != 1.0;
      const SimilarityWorld world =
          MakeWorld(seed, {.scale = scale, .stereo_source = !with_scale, .stereo_target = true});
      Random random(seed);
      const Similarity3d initial = Perturb(Disturbance(random, 0.05, with_scale), world.target_from_source);
      std::vector<std::uint8_t> inliers(world.pairs.size(), 1);
      const auto refined = RefineSimilarity(world.pairs, initial, {.with_scale = with_scale}, inliers);
      ASSERT_TRUE(refined) << "seed " << seed;
      EXPECT_EQ(refined->inliers, world.pairs.size());
      EXPECT_LT(Distance(refined->target_from_source, world.target_from_source), 1e-5) << "seed " << seed;
      if (!with_scale) {
        EXPECT_EQ(refined->target_from_source.scale(), 1.0);
      }
    }
  }
}

TEST(SimilarityRefinement, OutliersAreFoundAndDoNotMoveTheResult) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const bool with_scale = seed % 2 == 0;
    const SimilarityWorld world = MakeWorld(
        seed, {.scale = with_scale ? 0.7 : 1.0, .noise = 0.5, .outlier_ratio = 0.3, .stereo_source = !with_scale});
    Random random(seed);
    const Similarity3d initial = Perturb(Disturbance(random, 0.02, with_scale), world.target_from_source);
    std::vector<std::uint8_t> inliers(world.pairs.size(), 1);
    const auto refined = RefineSimilarity(world.pairs, initial, {.with_scale = with_scale}, inliers);
    ASSERT_TRUE(refined) << "seed " << seed;
    EXPECT_LT(Distance(refined->target_from_source, world.target_from_source), 0.02) << "seed " << seed;
    std::size_t kept_outliers = 0;
    for (std::size_t i = 0; i < inliers.size(); ++i) kept_outliers += inliers[i] != 0 && world.is_outlier[i] != 0;
    EXPECT_LE(kept_outliers, 3U) << "seed " << seed;
    EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(inliers, 1)), refined->inliers);
    EXPECT_NEAR(refined->mean_squared_error, 2.5, 1.0) << "two or three measurements an image, in sigmas";
  }
}

TEST(SimilarityRefinement, TooFewPairsOrANonsenseGuessGiveNothing) {
  const SimilarityWorld world = MakeWorld(1, {.pairs = 20});
  std::vector<std::uint8_t> few(5, 1);
  EXPECT_FALSE(RefineSimilarity(std::span(world.pairs).first(5), world.target_from_source, {}, few));
  EXPECT_EQ(std::ranges::count(few, 1), 0);
  std::vector<std::uint8_t> all(world.pairs.size(), 1);
  const Similarity3d nonsense(1.0, Eigen::Quaterniond::Identity(),
                              {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0});
  EXPECT_FALSE(RefineSimilarity(world.pairs, nonsense, {}, all));
  EXPECT_FALSE(SimilarityRefinementOptions{.rounds = 0}.Check());
  EXPECT_FALSE(SimilarityRefinementOptions{.min_inliers = 2}.Check());
  EXPECT_FALSE(SimilarityRefinementOptions{.stereo_chi2 = 0.0}.Check());
  EXPECT_TRUE(SimilarityRefinementOptions{}.Check());
}

}  // namespace
}  // namespace pangaea::testing
