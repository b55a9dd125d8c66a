#include "agent/mapping/local_bundle_adjustment.h"

#include "common/base/check.h"
#include "common/mapping/bundle_window.h"

namespace pangaea {
namespace {

BundleOptions SolverOptions(const LocalBundleAdjustmentOptions& options, std::stop_token stop) {
  BundleOptions solver;
  solver.solver = options.back_end == BundleAdjustmentBackEnd::kFast ? BundleSolver::kLocal : BundleSolver::kDenseSchur;
  solver.iterations = options.iterations;
  solver.iterations_without_outliers = options.iterations_without_outliers;
  solver.stop = std::move(stop);
  return solver;
}

}  // namespace

LocalAdjustment AdjustLocalMap(const Atlas& atlas, const AdjustmentWindow& window,
                               const LocalBundleAdjustmentOptions& options, const MeasurementNoiseOptions& noise,
                               std::stop_token stop) {
  LocalAdjustment adjustment;
  if (window.free.empty() || window.landmarks.empty()) return adjustment;
  const WindowBundle bundle =
      BuildWindowBundle(atlas, {.free = window.free, .fixed = window.fixed, .landmarks = window.landmarks}, noise);
  const auto result = SolveBundle(bundle.problem, SolverOptions(options, std::move(stop)));
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
  adjustment.removals = RemoveOutliers(atlas, bundle, result->outliers);
  return adjustment;
}

}  // namespace pangaea
