#include "common/mapping/bundle_window.h"

#include <algorithm>

namespace pangaea {
namespace {

int CameraIndex(BundleProblem& problem, const IdealCamera& camera) {
  for (std::size_t i = 0; i < problem.cameras.size(); ++i) {
    if (problem.cameras[i] == camera) return static_cast<int>(i);
  }
  problem.cameras.push_back(camera);
  return static_cast<int>(problem.cameras.size()) - 1;
}

void AddPoses(const Atlas& atlas, const std::vector<KeyframeId>& keyframes, bool fixed, WindowBundle& bundle) {
  for (const KeyframeId id : keyframes) {
    const Keyframe& keyframe = *atlas.FindKeyframe(id);
    bundle.pose_index[id] = static_cast<int>(bundle.problem.poses.size());
    bundle.keyframes.push_back(id);
    bundle.problem.poses.push_back({.camera_from_map = keyframe.camera_from_map,
                                    .camera = CameraIndex(bundle.problem, keyframe.data->camera),
                                    .fixed = fixed});
  }
}

// `data`: of the poses.
void AddPoint(const Landmark& landmark, const std::vector<const KeyframeData*>& data,
              const MeasurementNoiseOptions& noise, WindowBundle& bundle) {
  const int point = static_cast<int>(bundle.problem.points.size());
  bundle.landmarks.push_back(landmark.id);
  bundle.problem.points.push_back({.point_in_map = landmark.point_in_map});
  for (const Observation& observation : landmark.observations) {
    const auto pose = bundle.pose_index.find(observation.keyframe);
    if (pose == bundle.pose_index.end()) continue;
    const KeyframeData& observer = *data[static_cast<std::size_t>(pose->second)];
    const Keypoint& keypoint = observer.features.keypoints[observation.keypoint];
    bundle.problem.observations.push_back({.pose = pose->second,
                                           .point = point,
                                           .measurement = ReliableMeasurementOf(observer.camera, keypoint, noise),
                                           .inverse_sigma = 1.0 / SigmaOf(keypoint, noise)});
  }
}

bool HasDepth(const Atlas& atlas, const Observation& observation) {
  return atlas.FindKeyframe(observation.keyframe)->data->features.keypoints[observation.keypoint].has_depth();
}

// `outliers` ascend.
void RemoveFromLandmark(const Atlas& atlas, const Landmark& landmark, const std::vector<KeyframeId>& outliers,
                        std::vector<MapEdit>& edits) {
  std::vector<Observation> remaining;
  for (const Observation& observation : landmark.observations) {
    if (!std::binary_search(outliers.begin(), outliers.end(), observation.keyframe)) remaining.push_back(observation);
  }
  if (remaining.empty() || (remaining.size() == 1 && !HasDepth(atlas, remaining.front()))) {
    edits.push_back(RemoveLandmark{.id = landmark.id});
    return;
  }
  for (const KeyframeId keyframe : outliers) {
    edits.push_back(RemoveObservation{.landmark = landmark.id, .keyframe = keyframe});
  }
}

}  // namespace

WindowBundle BuildWindowBundle(const Atlas& atlas, const BundleWindow& window, const MeasurementNoiseOptions& noise) {
  WindowBundle bundle;
  AddPoses(atlas, window.free, false, bundle);
  AddPoses(atlas, window.fixed, true, bundle);
  std::vector<const KeyframeData*> data;
  for (const KeyframeId id : bundle.keyframes) data.push_back(atlas.FindKeyframe(id)->data.get());
  for (const LandmarkId id : window.landmarks) AddPoint(*atlas.FindLandmark(id), data, noise, bundle);
  return bundle;
}

std::vector<MapEdit> RemoveOutliers(const Atlas& atlas, const WindowBundle& bundle,
                                    std::span<const std::uint8_t> outliers) {
  std::vector<MapEdit> edits;
  std::size_t next = 0;
  const auto& observations = bundle.problem.observations;
  for (std::size_t point = 0; point < bundle.landmarks.size(); ++point) {
    std::vector<KeyframeId> of_landmark;
    for (; next < observations.size() && observations[next].point == static_cast<int>(point); ++next) {
      const auto pose = static_cast<std::size_t>(observations[next].pose);
      if (outliers[next] != 0) of_landmark.push_back(bundle.keyframes[pose]);
    }
    if (!of_landmark.empty()) {
      RemoveFromLandmark(atlas, *atlas.FindLandmark(bundle.landmarks[point]), of_landmark, edits);
    }
  }
  return edits;
}

}  // namespace pangaea
