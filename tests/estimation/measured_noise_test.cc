#include "common/estimation/measured_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/estimation/synthetic_world.h"

namespace pangaea::testing {
namespace {

BundleOptions Thorough(double least_noise) {
  BundleOptions options;
  options.iterations = 30;
  options.iterations_without_outliers = 30;
  options.cost_tolerance = 1e-10;
  options.least_noise = least_noise;
  return options;
}

double NoiseAfter(const BundleWorld& world) {
  const auto result = SolveBundle(world.problem, Thorough(1.0));
  EXPECT_TRUE(result);
  return MeasuredNoise(world.problem, result->poses, result->points);
}

TEST(MeasuredNoise, IsTheNoiseThatWasPutInWhateverTheSigmasSay) {
  for (const double noise : {0.1, 0.3, 0.7}) {
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      const BundleWorld world = MakeBundleWorld(seed, {.noise = noise, .stereo = seed % 2 == 0, .min_views = 4});
      EXPECT_NEAR(NoiseAfter(world), noise, 0.15 * noise) << "seed " << seed;
    }
  }
}

TEST(MeasuredNoise, WrongPointsChangeItLittle) {
  BundleWorld world = MakeBundleWorld(1, {.noise = 0.3, .min_views = 4});
  for (std::size_t i = 0; i < world.problem.points.size(); i += 5) {
    for (BundleObservation& observation : world.problem.observations) {
      if (observation.point == static_cast<int>(i)) observation.measurement.x() += observation.pose % 2 == 0 ? 4 : -4;
    }
  }
  EXPECT_NEAR(NoiseAfter(world), 0.3, 0.1);
}

TEST(MeasuredNoise, WherePointsAreSeenTooSeldomItIsInfinite) {
  BundleProblem problem;
  EXPECT_TRUE(std::isinf(MeasuredNoise(problem)));
}

// Moved by less than the sigmas allow, by more than the noise does.
class DisplacedObservations : public ::testing::TestWithParam<std::uint64_t> {
 protected:
  DisplacedObservations() : world_(MakeBundleWorld(GetParam(), {.noise = 0.2, .min_views = 6})) {
    for (std::size_t i = 0; i < world_.problem.observations.size(); i += 20) {
      world_.problem.observations[i].measurement.y() += 1.8;
      ++displaced_;
    }
  }

  std::size_t FoundWith(double least_noise) {
    const auto result = SolveBundle(world_.problem, Thorough(least_noise));
    EXPECT_TRUE(result);
    std::size_t found = 0;
    others_ = 0;
    for (std::size_t i = 0; i < result->outliers.size(); ++i) {
      (i % 20 == 0 ? found : others_) += result->outliers[i];
    }
    return found;
  }

  BundleWorld world_;
  std::size_t displaced_ = 0;
  std::size_t others_ = 0;  // outliers that were not displaced
};
INSTANTIATE_TEST_SUITE_P(Seeds, DisplacedObservations, ::testing::Range<std::uint64_t>(1, 5));

TEST_P(DisplacedObservations, AreFoundByTheNoiseAndNotByTheSigmas) {
  EXPECT_LT(FoundWith(1.0), displaced_ / 10);
  EXPECT_GT(FoundWith(0.1), 9 * displaced_ / 10);
  EXPECT_LT(others_, world_.problem.observations.size() / 100);
}

TEST_P(DisplacedObservations, AreFoundOnceAndWhatIsLeftStays) {
  const auto first = SolveBundle(world_.problem, Thorough(0.1));
  ASSERT_TRUE(first);
  BundleProblem rest = world_.problem;
  rest.observations.clear();
  for (std::size_t i = 0; i < first->outliers.size(); ++i) {
    if (first->outliers[i] == 0) rest.observations.push_back(world_.problem.observations[i]);
  }
  const auto second = SolveBundle(rest, Thorough(0.1));
  ASSERT_TRUE(second);
  EXPECT_LT(std::ranges::count(second->outliers, 1), static_cast<std::ptrdiff_t>(rest.observations.size() / 100));
}

}  // namespace
}  // namespace pangaea::testing
