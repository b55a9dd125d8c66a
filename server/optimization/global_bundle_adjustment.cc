#include "server/optimization/global_bundle_adjustment.h"

#include <algorithm>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>

#include "common/base/check.h"
#include "common/base/median.h"
#include "common/estimation/bundle_adjustment.h"
#include "common/map/edits/reference_scale.h"
#include "common/map/spanning_tree.h"

namespace pangaea {

BundleWindow WholeMap(const Atlas& atlas, MapId map) {
  BundleWindow window;
  const std::vector<KeyframeId> tree = ParentsFirst(atlas, map);
  window.fixed.assign(tree.begin(), tree.begin() + std::min<std::ptrdiff_t>(1, std::ssize(tree)));
  window.free.assign(tree.begin() + std::ssize(window.fixed), tree.end());
  std::sort(window.free.begin(), window.free.end());
  for (const KeyframeId id : tree) {
    for (const LandmarkId seen : atlas.FindKeyframe(id)->landmarks) {
      const Landmark* landmark = atlas.FindLandmark(seen);
      if (landmark == nullptr || landmark->reference != id || landmark->observations.size() < 2) continue;
      window.landmarks.push_back(seen);
    }
  }
  std::sort(window.landmarks.begin(), window.landmarks.end());
  return window;
}

namespace {

std::size_t CovisiblePairs(const Atlas& atlas, const std::vector<KeyframeId>& keyframes) {
  std::size_t ends = 0;
  for (const KeyframeId id : keyframes) ends += atlas.FindKeyframe(id)->covisible.size();
  return ends / 2;
}

BundleOptions SolverOptions(const GlobalBundleOptions& options, std::size_t pairs, std::stop_token stop) {
  BundleOptions solver;
  solver.solver = pairs <= options.direct_pairs ? BundleSolver::kSparse : BundleSolver::kIterativeSchur;
  solver.iterations = options.iterations;
  solver.iterations_without_outliers = options.iterations_without_outliers;
  solver.least_noise = options.least_noise;
  solver.cost_tolerance = options.cost_tolerance;
  solver.threads = options.threads;
  solver.max_seconds = options.max_seconds;
  solver.stop = std::move(stop);
  return solver;
}

// By how much the depths that a keyframe sees have grown: the median of the ratios. 1 where it sees nothing.
double DepthGrowth(std::vector<double> ratios) { return Median(std::move(ratios), 1.0); }

// The outcome in a map whose scale nothing measures: the whole drifts freely between the steps of an optimiser.
class ScaleFreeOutcome {
 public:
  ScaleFreeOutcome(const BundleProblem& problem, BundleResult& result) : problem_(problem), result_(result) {}

  // Scales the map about its fixed camera, so that depths have on the median grown by nothing. Returns by how much the
  // lengths around each pose have grown then.
  std::vector<double> Renormalize() {
    std::vector<std::vector<double>> ratios(problem_.poses.size());
    std::vector<double> all;
    for (std::size_t i = 0; i < problem_.observations.size(); ++i) {
      if (result_.outliers[i] != 0) continue;
      const BundleObservation& observation = problem_.observations[i];
      const auto pose = static_cast<std::size_t>(observation.pose);
      const auto point = static_cast<std::size_t>(observation.point);
      const double before = (problem_.poses[pose].camera_from_map * problem_.points[point].point_in_map).z();
      const double after = (result_.poses[pose] * result_.points[point]).z();
      if (!(before > 0.0) || !(after > 0.0)) continue;
      ratios[pose].push_back(after / before);
      all.push_back(after / before);
    }
    const double growth = DepthGrowth(all);
    ScaleAboutTheFixedCamera(1.0 / growth);
    std::vector<double> scales;
    for (auto& of_pose : ratios) scales.push_back(of_pose.empty() ? 1.0 : DepthGrowth(of_pose) / growth);
    return scales;
  }

 private:
  void ScaleAboutTheFixedCamera(double scale) {
    const auto fixed = std::ranges::find_if(problem_.poses, &BundlePose::fixed) - problem_.poses.begin();
    const Eigen::Vector3d center = result_.poses[static_cast<std::size_t>(fixed)].Inverse().translation();
    const Similarity3d scaling(scale, Eigen::Quaterniond::Identity(), (1.0 - scale) * center);
    for (std::size_t i = 0; i < result_.poses.size(); ++i) {
      if (!problem_.poses[i].fixed) result_.poses[i] = scaling.TransformCamera(result_.poses[i]);
    }
    for (Eigen::Vector3d& point : result_.points) point = scaling * point;
  }

  const BundleProblem& problem_;
  BundleResult& result_;
};

// The adjusted poses; of keyframes that see too little, their parents'. In the order of the tree. The root, which holds
// the map in place, as well: from now on the server alone moves it like the others, and agents are told what it sees.
std::vector<CorrectedKeyframe> Keyframes(const Atlas& atlas, MapId map, const WindowBundle& bundle,
                                         const BundleResult& result, std::span<const double> scales,
                                         std::size_t min_observations) {
  std::vector<std::size_t> observations(bundle.keyframes.size(), 0);
  for (const BundleObservation& observation : bundle.problem.observations) {
    ++observations[static_cast<std::size_t>(observation.pose)];
  }
  std::unordered_map<KeyframeId, CorrectedKeyframe> corrected;
  std::vector<CorrectedKeyframe> keyframes;
  for (const KeyframeId id : ParentsFirst(atlas, map)) {
    const auto pose = static_cast<std::size_t>(bundle.pose_index.at(id));
    const Keyframe& before = *atlas.FindKeyframe(id);
    CorrectedKeyframe after{id, result.poses[pose], scales[pose]};
    if (before.parent.valid() && observations[pose] < min_observations) {
      const CorrectedKeyframe& parent = corrected.at(before.parent);
      const Rigid3d from_parent = before.camera_from_map * atlas.FindKeyframe(before.parent)->camera_from_map.Inverse();
      after.camera_from_map = ScaleLengths(from_parent, parent.scale) * parent.camera_from_map;
      after.scale = parent.scale;
    }
    corrected[id] = after;
    keyframes.push_back(after);
  }
  return keyframes;
}

}  // namespace

Status GlobalBundleOptions::Check() const {
  const auto refuse = [](const char* what) {
    return Fail(ErrorCode::kInvalidArgument, std::string("global bundle adjustment: ") + what);
  };
  if (!(noise.pixel_sigma > 0.0)) return refuse("noise.pixel_sigma must be > 0");
  if (!(noise.max_depth_baselines > 0.0)) return refuse("noise.max_depth_baselines must be > 0");
  if (!(least_noise > 0.0) || !(least_noise <= 1.0)) return refuse("least_noise must be above 0 and at most 1");
  if (auto status = visits.Check(); !status) return refuse(status.error().message.c_str());
  if (iterations < 1) return refuse("iterations must be >= 1");
  if (iterations_without_outliers < 0) return refuse("iterations_without_outliers must be >= 0");
  if (!(cost_tolerance >= 0.0)) return refuse("cost_tolerance must be >= 0");
  if (threads < 1) return refuse("threads must be >= 1");
  if (!(max_seconds >= 0.0)) return refuse("max_seconds must be >= 0");
  return {};
}

std::optional<GlobalBundle> AdjustMap(const Atlas& snapshot, MapId map, const GlobalBundleOptions& options,
                                      std::stop_token stop, const std::function<bool()>& out_of_time) {
  PANGAEA_CHECK(options.Check().has_value());
  const BundleWindow window = WholeMap(snapshot, map);
  if (window.free.empty() || window.landmarks.empty() || stop.stop_requested()) return std::nullopt;
  const WindowBundle bundle = BuildWindowBundle(snapshot, window, options.noise);
  if (stop.stop_requested()) return std::nullopt;
  const std::size_t pairs = CovisiblePairs(snapshot, bundle.keyframes);
  BundleOptions solver = SolverOptions(options, pairs, std::move(stop));
  solver.out_of_time = out_of_time;
  auto result = SolveByVisits(bundle, options.visits, solver);
  // A number out of all bounds in the map itself: nothing to adjust.
  if (!result || result->cancelled) return std::nullopt;

  std::vector<double> scales(bundle.keyframes.size(), 1.0);
  const bool has_scale = std::ranges::any_of(bundle.problem.cameras, &IdealCamera::is_stereo);
  if (!has_scale) scales = ScaleFreeOutcome(bundle.problem, *result).Renormalize();
  GlobalBundle adjusted{.correction = {.base = snapshot, .map = map, .keyframes = {}, .landmarks = {}},
                        .removals = RemoveOutliers(snapshot, bundle, result->outliers),
                        .observations = bundle.problem.observations.size(),
                        .outliers = static_cast<std::size_t>(std::ranges::count(result->outliers, 1)),
                        .final_cost = result->final_cost,
                        .iterations = result->iterations};
  adjusted.correction.keyframes = Keyframes(snapshot, map, bundle, *result, scales, options.min_observations);
  for (std::size_t i = 0; i < bundle.landmarks.size(); ++i) {
    adjusted.correction.landmarks.push_back({bundle.landmarks[i], result->points[i]});
  }
  return adjusted;
}

}  // namespace pangaea
