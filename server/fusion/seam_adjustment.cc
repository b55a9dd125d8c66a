#include "server/fusion/seam_adjustment.h"

#include <algorithm>
#include <set>
#include <utility>

#include "common/base/check.h"
#include "common/estimation/bundle_adjustment.h"
#include "common/map/covisibility.h"

namespace pangaea {
namespace {

BundleWindow ToBundleWindow(const Atlas& atlas, const WeldingWindow& window) {
  const std::set<KeyframeId> fixed(window.fixed.begin(), window.fixed.end());
  BundleWindow bundle{.free = {}, .fixed = window.fixed, .landmarks = {}};
  for (const auto* side : {&window.kept, &window.moved}) {
    std::copy_if(side->begin(), side->end(), std::back_inserter(bundle.free),
                 [&](KeyframeId id) { return !fixed.contains(id); });
  }
  std::vector<KeyframeId> all = bundle.free;
  all.insert(all.end(), bundle.fixed.begin(), bundle.fixed.end());
  bundle.landmarks = TyingLandmarks(atlas, all);
  // What only fixed keyframes see does not tie anything that moves.
  const LandmarkIdSet of_free = LandmarkSetOf(atlas, bundle.free);
  std::erase_if(bundle.landmarks, [&of_free](LandmarkId id) { return !of_free.Contains(id); });
  return bundle;
}

}  // namespace

std::vector<LandmarkId> TyingLandmarks(const Atlas& atlas, const std::vector<KeyframeId>& keyframes) {
  LandmarkIdSet seen;
  LandmarkIdSet tying;
  for (const KeyframeId id : keyframes) {
    for (const LandmarkId landmark : atlas.FindKeyframe(id)->landmarks) {
      if (landmark.valid() && !seen.Insert(landmark)) tying.Insert(landmark);
    }
  }
  return tying.Ascending();
}

std::optional<SeamAdjustment> AdjustSeam(const Atlas& atlas, const WeldingWindow& window, const FusionOptions& options,
                                         std::stop_token stop) {
  SeamAdjustment adjustment;
  adjustment.bundle = BuildWindowBundle(atlas, ToBundleWindow(atlas, window), options.noise);
  BundleOptions solver;
  solver.iterations = options.iterations;
  solver.iterations_without_outliers = options.iterations_without_outliers;
  solver.cost_tolerance = options.cost_tolerance;
  solver.stop = std::move(stop);
  auto result = SolveBundle(adjustment.bundle.problem, solver);
  PANGAEA_CHECK(result.has_value());
  if (result->cancelled) return std::nullopt;
  BundleProblem& problem = adjustment.bundle.problem;
  for (std::size_t i = 0; i < problem.poses.size(); ++i) problem.poses[i].camera_from_map = result->poses[i];
  for (std::size_t i = 0; i < problem.points.size(); ++i) problem.points[i].point_in_map = result->points[i];
  adjustment.outliers = std::move(result->outliers);
  return adjustment;
}

void TakeAdjustment(const SeamAdjustment& adjustment, WeldingDraft& draft) {
  const WindowBundle& bundle = adjustment.bundle;
  std::vector<std::pair<KeyframeId, Rigid3d>> poses;
  for (std::size_t i = 0; i < bundle.keyframes.size(); ++i) {
    const BundlePose& pose = bundle.problem.poses[i];
    if (!pose.fixed) poses.emplace_back(bundle.keyframes[i], pose.camera_from_map);
  }
  std::vector<std::pair<LandmarkId, Eigen::Vector3d>> points;
  for (std::size_t i = 0; i < bundle.landmarks.size(); ++i) {
    points.emplace_back(bundle.landmarks[i], bundle.problem.points[i].point_in_map);
  }
  draft.Move(poses, std::move(points));
  draft.Change(RemoveOutliers(draft.welded(), bundle, adjustment.outliers));
}

}  // namespace pangaea
