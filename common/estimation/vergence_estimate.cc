#include "common/estimation/vergence_estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/geometry/vergence.h"

namespace pangaea {
namespace {

constexpr int kRounds = 10;                // for errors of many pixels, which the robust kernel hides at first
constexpr double kStepPixels = 1.0;        // to either side: well above rounding, below where outliers begin
constexpr double kConvergedPixels = 0.05;  // a round that moves it by less is the last
constexpr double kMostSteps = 4.0;         // in one round: what lies beyond is no parabola any more

const IdealCamera& CameraOf(const BundleProblem& problem, const BundleObservation& observation) {
  return problem.cameras[static_cast<std::size_t>(problem.poses[static_cast<std::size_t>(observation.pose)].camera)];
}

void Turn(BundleProblem& problem, double vergence) {
  for (BundleObservation& observation : problem.observations) {
    if (!IsStereo(observation.measurement)) continue;
    const IdealCamera& camera = CameraOf(problem, observation);
    observation.measurement.z() -= VergenceShift(camera, observation.measurement.x(), vergence);
    // Columns beyond the edge are fine here, but negative ones mean that there is none.
    observation.measurement.z() = std::max(observation.measurement.z(), 0.0);
  }
}

std::optional<double> AdjustedCost(BundleProblem problem, const BundleOptions& options, double vergence) {
  Turn(problem, vergence);
  const auto result = SolveBundle(problem, options);
  if (!result || result->cancelled) return std::nullopt;
  return result->final_cost;
}

// One round of the search. Where the cost does not bend upwards, all is far off and the robust kernel hides by how
// much: then the bottom lies somewhere down the slope, and `sigma` is infinite.
std::optional<VergenceEstimate> BottomOfParabola(const BundleProblem& problem, const BundleOptions& options,
                                                 double around, double step) {
  const auto less = AdjustedCost(problem, options, around - step);
  const auto here = AdjustedCost(problem, options, around);
  const auto more = AdjustedCost(problem, options, around + step);
  if (!less || !here || !more) return std::nullopt;
  const double slope = (*more - *less) / (2.0 * step);
  const double curvature = (*less + *more - 2.0 * *here) / (step * step);
  if (!(curvature > 0.0)) {
    return VergenceEstimate{around - std::copysign(kMostSteps * step, slope), std::numeric_limits<double>::infinity()};
  }
  const double shift = std::clamp(-slope / curvature, -kMostSteps * step, kMostSteps * step);
  return VergenceEstimate{around + shift, 1.0 / std::sqrt(curvature)};
}

}  // namespace

std::optional<VergenceEstimate> EstimateVergence(const BundleProblem& problem, BundleOptions options) {
  const bool stereo = std::ranges::any_of(problem.observations, [](const auto& o) { return IsStereo(o.measurement); });
  if (!stereo) return std::nullopt;
  options.iterations_without_outliers = 0;
  const double pixel = 1.0 / problem.cameras.front().focal_x;
  VergenceEstimate estimate;
  for (int round = 0; round < kRounds; ++round) {
    const auto next = BottomOfParabola(problem, options, estimate.vergence, kStepPixels * pixel);
    if (!next) return std::nullopt;
    const double moved = next->vergence - std::exchange(estimate, *next).vergence;
    if (std::abs(moved) < kConvergedPixels * pixel) return estimate;
  }
  return std::nullopt;
}

}  // namespace pangaea
