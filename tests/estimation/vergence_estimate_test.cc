#include "common/estimation/vergence_estimate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/vergence.h"
#include "tests/estimation/synthetic_world.h"

namespace pangaea {
namespace {

using testing::BundleWorldOptions;
using testing::MakeBundleWorld;
using testing::StereoCamera;

BundleOptions Patient() {
  BundleOptions options;
  options.iterations = 30;
  options.cost_tolerance = 1e-7;
  return options;
}

// What cameras see whose right one is turned by `vergence` against the calibration.
BundleProblem Seen(BundleWorldOptions options, std::uint64_t seed, double vergence) {
  options.free_poses = 9;
  options.fixed_poses = 1;
  BundleProblem problem = MakeBundleWorld(seed, options).problem;
  for (BundleObservation& observation : problem.observations) {
    if (!IsStereo(observation.measurement)) continue;
    observation.measurement.z() += VergenceShift(problem.cameras[0], observation.measurement.x(), vergence);
  }
  return problem;
}

double Pixels(double vergence) { return vergence * StereoCamera().focal_x; }

TEST(VergenceEstimate, FindsTheVergenceAsExactlyAsItSays) {
  constexpr int kSeeds = 30;
  double sum = 0.0;  // of the squared errors in sigmas
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const double truth = 0.0005 * (static_cast<double>(seed % 7) - 3.0);
    const auto estimate = EstimateVergence(Seen({.noise = 1.0}, seed, truth), Patient());
    ASSERT_TRUE(estimate) << "seed " << seed;
    EXPECT_LT(Pixels(estimate->sigma), 0.5) << "seed " << seed;
    const double error = (estimate->vergence - truth) / estimate->sigma;
    sum += error * error;
  }
  EXPECT_GT(std::sqrt(sum / kSeeds), 0.6);
  EXPECT_LT(std::sqrt(sum / kSeeds), 1.6);  // the robust kernel costs a little
}

TEST(VergenceEstimate, ManyPixelsAreFoundInSeveralRounds) {
  for (const double truth : {-0.02, 0.015}) {
    const auto estimate = EstimateVergence(Seen({.noise = 0.3}, 3, truth), Patient());
    ASSERT_TRUE(estimate);
    EXPECT_NEAR(Pixels(estimate->vergence), Pixels(truth), 0.25);
  }
}

TEST(VergenceEstimate, WrongMatchesDoNotPretendOne) {
  const auto estimate = EstimateVergence(Seen({.noise = 0.5, .outlier_ratio = 0.05}, 5, 0.0), Patient());
  ASSERT_TRUE(estimate);
  EXPECT_LT(std::abs(Pixels(estimate->vergence)), 0.2);
}

TEST(VergenceEstimate, OneCameraAloneHasNone) {
  EXPECT_FALSE(EstimateVergence(Seen({.stereo = false}, 1, 0.0), Patient()));
}

TEST(VergenceEstimate, NothingComesOfAnAdjustmentThatFailsOrStops) {
  BundleProblem broken = Seen({}, 1, 0.0);
  broken.observations.front().point = 1'000'000;
  EXPECT_FALSE(EstimateVergence(broken, Patient()));
  std::stop_source stop;
  stop.request_stop();
  BundleOptions stopped = Patient();
  stopped.stop = stop.get_token();
  EXPECT_FALSE(EstimateVergence(Seen({}, 1, 0.001), stopped));
}

}  // namespace
}  // namespace pangaea
