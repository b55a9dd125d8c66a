#include "agent/tracking/local_map.h"

#include <algorithm>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "common/base/check.h"
#include "common/map/covisibility.h"

namespace pangaea {
namespace {

// Collects the poses of the templates' keyframes, each once.
class ViewPoses {
 public:
  ViewPoses(const Atlas& atlas, std::vector<Rigid3d>& poses) : atlas_(atlas), poses_(poses) {}

  // Nothing when the keyframe is not of this atlas any more.
  std::optional<std::size_t> IndexOf(KeyframeId id) {
    const auto [entry, is_new] = indices_.try_emplace(id);
    if (is_new) entry->second = Add(id);
    return entry->second;
  }

 private:
  std::optional<std::size_t> Add(KeyframeId id) {
    const auto resolved = atlas_.ResolvePose(id);
    if (!resolved) return std::nullopt;
    poses_.push_back(resolved->keyframe_from_asked.Inverse() * resolved->keyframe->camera_from_map);
    return poses_.size() - 1;
  }

  const Atlas& atlas_;
  std::vector<Rigid3d>& poses_;
  std::unordered_map<KeyframeId, std::optional<std::size_t>> indices_;
};

void AttachViews(const TemplateStore& templates, ViewPoses& poses, LocalLandmark& landmark) {
  for (const PatchTemplate& patch : templates.Find(landmark.id)) {
    if (const auto pose = poses.IndexOf(patch.keyframe)) {
      landmark.views[static_cast<std::size_t>(landmark.view_count++)] = LandmarkView{&patch, *pose};
    }
  }
}

// Positions of the observers, each looked up once.
class ObserverCenters {
 public:
  explicit ObserverCenters(const Atlas& atlas) : atlas_(atlas) {}

  void Summarise(const Landmark& landmark, LocalLandmark& entry) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double squares = 0.0;
    double stereo = 0.0;
    for (const Observation& observation : landmark.observations) {
      const Observer& observer = Find(observation.keyframe);
      sum += observer.center;
      squares += observer.center.squaredNorm();
      // The right camera is one more observer, a baseline away: half of its square about their own centre.
      if (observer.keyframe->data->features.keypoints[observation.keypoint].has_depth()) {
        const double baseline = observer.keyframe->data->camera.baseline;
        stereo += 0.5 * baseline * baseline;
      }
    }
    const auto count = static_cast<double>(landmark.observations.size());
    entry.observers_center = sum / count;
    entry.observers_spread = std::max(squares - sum.squaredNorm() / count, 0.0) + stereo;
  }

 private:
  struct Observer {
    const Keyframe* keyframe = nullptr;
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
  };

  const Observer& Find(KeyframeId id) {
    Observer& observer = observers_[id];
    if (observer.keyframe != nullptr) return observer;
    observer.keyframe = atlas_.FindKeyframe(id);
    PANGAEA_CHECK(observer.keyframe != nullptr);
    observer.center = observer.keyframe->camera_from_map.Inverse().translation();
    return observer;
  }

  const Atlas& atlas_;
  std::unordered_map<KeyframeId, Observer> observers_;
};

}  // namespace

double PredictionVariance(const LocalLandmark& landmark, const Eigen::Vector3d& camera_in_map) {
  const double distance = (camera_in_map - landmark.observers_center).squaredNorm();
  const double of_the_mean = 1.0 / landmark.observations;
  return 1.0 + of_the_mean + distance / std::max(landmark.observers_spread, 1e-12);
}

LocalMap CollectLocalMap(const Atlas& atlas, KeyframeId reference, const TemplateStore& templates,
                         const LocalMap& previous, const LocalMapOptions& options) {
  LocalMap local;
  local.keyframes = GrowWindow(atlas, reference, options.max_keyframes);
  std::unordered_map<LandmarkId, const LocalLandmark*> known;
  for (const LocalLandmark& landmark : previous.landmarks) known.emplace(landmark.id, &landmark);
  ObserverCenters centers(atlas);
  ViewPoses poses(atlas, local.view_poses);
  std::unordered_set<LandmarkId> seen;
  for (const KeyframeId id : local.keyframes) {
    const Keyframe* keyframe = atlas.FindKeyframe(id);
    PANGAEA_CHECK(keyframe != nullptr);
    for (const LandmarkId landmark_id : keyframe->landmarks) {
      if (!landmark_id.valid() || !seen.insert(landmark_id).second) continue;
      const Landmark* landmark = atlas.FindLandmark(landmark_id);
      PANGAEA_CHECK(landmark != nullptr);
      LocalLandmark& entry = local.landmarks.emplace_back();
      entry.id = landmark_id;
      entry.point_in_map = landmark->point_in_map;
      entry.observations = static_cast<int>(landmark->observations.size());
      centers.Summarise(*landmark, entry);
      AttachViews(templates, poses, entry);
      const auto before = known.find(landmark_id);
      if (before == known.end()) continue;
      entry.failures = before->second->failures;
      entry.tracked = before->second->tracked;
    }
  }
  return local;
}

}  // namespace pangaea
