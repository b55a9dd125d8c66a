#include "agent/mapping/local_bundle_adjustment.h"

#include <algorithm>

#include "common/base/check.h"
#include "common/mapping/landmark_visits.h"

namespace pangaea {
namespace {

WindowBundle BuildBundle(const Atlas& atlas, const AdjustmentWindow& window, const MeasurementNoiseOptions& noise) {
  BundleWindow all{.free = window.free, .fixed = window.fixed, .landmarks = window.landmarks};
  all.landmarks.insert(all.landmarks.end(), window.held.begin(), window.held.end());
  WindowBundle bundle = BuildWindowBundle(atlas, all, noise);
  for (std::size_t i = window.landmarks.size(); i < all.landmarks.size(); ++i) bundle.problem.points[i].fixed = true;
  return bundle;
}

// Of landmarks that are the session's to judge, what its keyframes see wrongly goes; of those it may only read, its own
// observations.
std::vector<MapEdit> RemoveOwnOutliers(const Atlas& atlas, const AdjustmentWindow& window, const WindowBundle& bundle,
                                       std::vector<std::uint8_t> outliers) {
  const SessionId session = window.free.front().session;
  std::vector<MapEdit> of_held;
  for (std::size_t i = 0; i < outliers.size(); ++i) {
    if (outliers[i] == 0) continue;
    const BundleObservation& observation = bundle.problem.observations[i];
    const KeyframeId keyframe = bundle.keyframes[static_cast<std::size_t>(observation.pose)];
    const auto point = static_cast<std::size_t>(observation.point);
    const bool held = point >= window.landmarks.size();
    if (held && keyframe.session == session) of_held.emplace_back(RemoveObservation{bundle.landmarks[point], keyframe});
    if (held || keyframe.session != session) outliers[i] = 0;
  }
  std::vector<MapEdit> removals = RemoveOutliers(atlas, bundle, outliers);
  removals.insert(removals.end(), of_held.begin(), of_held.end());
  return removals;
}

BundleSolver SolverFor(BundleAdjustmentBackEnd back_end, std::size_t free_keyframes) {
  if (back_end == BundleAdjustmentBackEnd::kCeres) return BundleSolver::kDenseSchur;
  return free_keyframes <= kDenseKeyframes ? BundleSolver::kLocal : BundleSolver::kSparse;
}

BundleOptions SolverOptions(const LocalBundleAdjustmentOptions& options, std::size_t free_keyframes,
                            std::stop_token stop) {
  BundleOptions solver;
  solver.solver = SolverFor(options.back_end, free_keyframes);
  solver.iterations = options.iterations;
  solver.iterations_without_outliers = options.iterations_without_outliers;
  solver.cost_tolerance = options.cost_tolerance;
  solver.stop = std::move(stop);
  return solver;
}

// One camera alone has its scale from holding on to what it sees again (docs/decisions/0033-visits.md).
bool HasScale(const BundleProblem& problem) { return std::ranges::any_of(problem.cameras, &IdealCamera::is_stereo); }

// Moves the start of a problem to where it comes together as if every landmark had but one visit.
void PullTogether(int iterations, BundleOptions solver, BundleProblem& problem) {
  solver.iterations = iterations;
  solver.iterations_without_outliers = 0;
  const auto result = SolveBundle(problem, solver);
  PANGAEA_CHECK(result.has_value());
  StartFrom(*result, problem);
}

}  // namespace

LocalAdjustment AdjustLocalMap(const Atlas& atlas, const AdjustmentWindow& window,
                               const LocalBundleAdjustmentOptions& options, const MeasurementNoiseOptions& noise,
                               std::stop_token stop) {
  LocalAdjustment adjustment;
  if (window.free.empty() || window.landmarks.size() + window.held.size() == 0) return adjustment;
  WindowBundle bundle = BuildBundle(atlas, window, noise);
  const BundleOptions solver = SolverOptions(options, window.free.size(), std::move(stop));
  const bool by_visits = options.visits && HasScale(bundle.problem);
  if (by_visits && options.iterations_together > 0) PullTogether(options.iterations_together, solver, bundle.problem);
  const auto result = by_visits ? SolveByVisits(bundle, *options.visits, solver) : SolveBundle(bundle.problem, solver);
  PANGAEA_CHECK(result.has_value());
  for (std::size_t i = 0; i < window.free.size(); ++i) {
    adjustment.camera_from_map.emplace_back(window.free[i], result->poses[i]);
  }
  for (std::size_t i = 0; i < window.landmarks.size(); ++i) {
    adjustment.point_in_map.emplace_back(window.landmarks[i], result->points[i]);
  }
  for (const LandmarkId id : window.carried) {
    const Landmark& landmark = *atlas.FindLandmark(id);
    const Rigid3d& before = atlas.FindKeyframe(landmark.reference)->camera_from_map;
    const Rigid3d& after = result->poses[static_cast<std::size_t>(bundle.pose_index.at(landmark.reference))];
    adjustment.point_in_map.emplace_back(id, after.Inverse() * (before * landmark.point_in_map));
  }
  adjustment.outlier_share = static_cast<double>(std::ranges::count(result->outliers, 1)) /
                             std::max<double>(1.0, static_cast<double>(result->outliers.size()));
  adjustment.removals = RemoveOwnOutliers(atlas, window, bundle, result->outliers);
  return adjustment;
}

}  // namespace pangaea
