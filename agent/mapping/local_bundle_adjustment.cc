#include "agent/mapping/local_bundle_adjustment.h"

#include <algorithm>
#include <unordered_map>

#include "agent/mapping/measurement_noise.h"
#include "common/base/check.h"
#include "common/estimation/bundle_adjustment.h"

namespace pangaea {
namespace {

// The window in numbers, and what the numbers stand for.
struct WindowProblem {
  BundleProblem bundle;
  std::unordered_map<KeyframeId, int> pose_index;
  std::vector<KeyframeId> keyframe_of_observation;
};

int CameraIndex(BundleProblem& problem, const IdealCamera& camera) {
  for (std::size_t i = 0; i < problem.cameras.size(); ++i) {
    if (problem.cameras[i] == camera) return static_cast<int>(i);
  }
  problem.cameras.push_back(camera);
  return static_cast<int>(problem.cameras.size()) - 1;
}

void AddPoses(const Atlas& atlas, const std::vector<KeyframeId>& keyframes, bool fixed, WindowProblem& problem) {
  for (const KeyframeId id : keyframes) {
    const Keyframe& keyframe = *atlas.FindKeyframe(id);
    problem.pose_index[id] = static_cast<int>(problem.bundle.poses.size());
    problem.bundle.poses.push_back({.camera_from_map = keyframe.camera_from_map,
                                    .camera = CameraIndex(problem.bundle, keyframe.data->camera),
                                    .fixed = fixed});
  }
}

void AddPoints(const Atlas& atlas, const std::vector<LandmarkId>& landmarks, const MeasurementNoiseOptions& noise,
               WindowProblem& problem) {
  for (const LandmarkId id : landmarks) {
    const Landmark& landmark = *atlas.FindLandmark(id);
    const int point = static_cast<int>(problem.bundle.points.size());
    problem.bundle.points.push_back({.point_in_map = landmark.point_in_map});
    for (const Observation& observation : landmark.observations) {
      const auto pose = problem.pose_index.find(observation.keyframe);
      if (pose == problem.pose_index.end()) continue;
      const Keyframe& keyframe = *atlas.FindKeyframe(observation.keyframe);
      const Keypoint& keypoint = keyframe.data->features.keypoints[observation.keypoint];
      problem.bundle.observations.push_back(
          {.pose = pose->second,
           .point = point,
           .measurement = ReliableMeasurementOf(keyframe.data->camera, keypoint, noise),
           .inverse_sigma = 1.0 / SigmaOf(keypoint, noise)});
      problem.keyframe_of_observation.push_back(observation.keyframe);
    }
  }
}

WindowProblem BuildProblem(const Atlas& atlas, const AdjustmentWindow& window, const MeasurementNoiseOptions& noise) {
  WindowProblem problem;
  AddPoses(atlas, window.free, false, problem);
  AddPoses(atlas, window.fixed, true, problem);
  AddPoints(atlas, window.landmarks, noise, problem);
  return problem;
}

BundleOptions SolverOptions(const LocalBundleAdjustmentOptions& options, std::stop_token stop) {
  BundleOptions solver;
  solver.solver = options.back_end == BundleAdjustmentBackEnd::kFast ? BundleSolver::kLocal : BundleSolver::kDenseSchur;
  solver.iterations = options.iterations;
  solver.iterations_without_outliers = options.iterations_without_outliers;
  solver.stop = std::move(stop);
  return solver;
}

bool HasDepth(const Atlas& atlas, const Observation& observation) {
  return atlas.FindKeyframe(observation.keyframe)->data->features.keypoints[observation.keypoint].has_depth();
}

// The landmark goes when what remains does not determine it: two views, or one with depth.
std::vector<MapEdit> RemoveFromLandmark(const Atlas& atlas, const Landmark& landmark,
                                        const std::vector<KeyframeId>& outliers) {
  std::vector<Observation> remaining;
  for (const Observation& observation : landmark.observations) {
    if (!std::binary_search(outliers.begin(), outliers.end(), observation.keyframe)) remaining.push_back(observation);
  }
  if (remaining.empty() || (remaining.size() == 1 && !HasDepth(atlas, remaining.front()))) {
    return {RemoveLandmark{.id = landmark.id}};
  }
  std::vector<MapEdit> edits;
  for (const KeyframeId keyframe : outliers) {
    edits.push_back(RemoveObservation{.landmark = landmark.id, .keyframe = keyframe});
  }
  return edits;
}

std::vector<MapEdit> RemoveOutliers(const Atlas& atlas, const AdjustmentWindow& window, const WindowProblem& problem,
                                    const BundleResult& result) {
  std::vector<MapEdit> edits;
  std::size_t next = 0;
  const auto& observations = problem.bundle.observations;  // landmark by landmark, ascending by keyframe
  for (std::size_t point = 0; point < window.landmarks.size(); ++point) {
    std::vector<KeyframeId> outliers;
    for (; next < observations.size() && observations[next].point == static_cast<int>(point); ++next) {
      if (result.outliers[next] != 0) outliers.push_back(problem.keyframe_of_observation[next]);
    }
    if (outliers.empty()) continue;
    for (MapEdit& edit : RemoveFromLandmark(atlas, *atlas.FindLandmark(window.landmarks[point]), outliers)) {
      edits.push_back(std::move(edit));
    }
  }
  return edits;
}

}  // namespace

LocalAdjustment AdjustLocalMap(const Atlas& atlas, const AdjustmentWindow& window,
                               const LocalBundleAdjustmentOptions& options, const MeasurementNoiseOptions& noise,
                               std::stop_token stop) {
  LocalAdjustment adjustment;
  if (window.free.empty() || window.landmarks.empty()) return adjustment;
  const WindowProblem problem = BuildProblem(atlas, window, noise);
  const auto result = SolveBundle(problem.bundle, SolverOptions(options, std::move(stop)));
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
    const Rigid3d& after = result->poses[static_cast<std::size_t>(problem.pose_index.at(landmark.reference))];
    adjustment.point_in_map.emplace_back(id, after.Inverse() * (before * landmark.point_in_map));
  }
  adjustment.removals = RemoveOutliers(atlas, window, problem, *result);
  return adjustment;
}

}  // namespace pangaea
