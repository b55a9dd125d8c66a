#include "agent/tracking/local_map.h"

#include <algorithm>
#include <optional>
#include <unordered_map>

#include "agent/tracking/resolved_pose.h"
#include "common/base/check.h"
#include "common/geometry/reprojection.h"
#include "common/map/covisibility.h"
#include "common/map/id_set.h"

namespace pangaea {
namespace {

// Collects the poses of the keyframes that templates and sightings are of, each once.
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
    const auto pose = PoseOf(atlas_, id);
    if (!pose) return std::nullopt;
    poses_.push_back(*pose);
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

// Observations ascend by session and counter.
const Observation* NewestObservation(const Landmark& landmark, SessionId session) {
  const auto of_session = [session](const Observation& observation) { return observation.keyframe.session == session; };
  const auto newest = std::find_if(landmark.observations.rbegin(), landmark.observations.rend(), of_session);
  return newest == landmark.observations.rend() ? nullptr : &*newest;
}

std::optional<Sighting> LatestSighting(const Atlas& atlas, const Landmark& landmark, SessionId session,
                                       ViewPoses& poses) {
  const Observation* observation = NewestObservation(landmark, session);
  if (observation == nullptr) return std::nullopt;
  const Keyframe& keyframe = *atlas.FindKeyframe(observation->keyframe);
  const Eigen::Vector3d point = keyframe.camera_from_map * landmark.point_in_map;
  if (point.z() <= 0.0) return std::nullopt;
  const Keypoint& keypoint = keyframe.data->features.keypoints[observation->keypoint];
  const Eigen::Vector2d beside = Eigen::Vector2d(keypoint.u, keypoint.v) - keyframe.data->camera.Project(point);
  const double sigma = OctaveSigma(keypoint.octave);  // wider than mapping's: what that has kept is meant to pass
  if (beside.squaredNorm() > kMonocularChi2 * sigma * sigma) return std::nullopt;
  const auto pose = poses.IndexOf(keyframe.id);
  if (!pose) return std::nullopt;
  return Sighting{*pose, beside};
}

}  // namespace

LocalMap CollectLocalMap(const Atlas& atlas, KeyframeId reference, const TemplateStore& templates,
                         const LocalMap& previous, const LocalMapOptions& options) {
  LocalMap local;
  local.keyframes = GrowWindow(atlas, reference, options.max_keyframes);
  std::unordered_map<LandmarkId, const LocalLandmark*> known;
  for (const LocalLandmark& landmark : previous.landmarks) {
    if (landmark.tracked || landmark.failures > 0) known.emplace(landmark.id, &landmark);
  }
  ObserverCenters centers(atlas);
  ViewPoses poses(atlas, local.view_poses);
  LandmarkIdSet seen;
  local.landmarks.reserve(previous.landmarks.size() + previous.landmarks.size() / 8);
  for (const KeyframeId id : local.keyframes) {
    const Keyframe* keyframe = atlas.FindKeyframe(id);
    PANGAEA_CHECK(keyframe != nullptr);
    for (const LandmarkId landmark_id : keyframe->landmarks) {
      if (!landmark_id.valid() || !seen.Insert(landmark_id)) continue;
      const Landmark* landmark = atlas.FindLandmark(landmark_id);
      PANGAEA_CHECK(landmark != nullptr);
      LocalLandmark& entry = local.landmarks.emplace_back();
      entry.id = landmark_id;
      entry.point_in_map = landmark->point_in_map;
      entry.observers = centers.SpreadOf(*landmark);
      AttachViews(templates, poses, entry);
      if (entry.view_count > 0) {
        entry.latest_sighting = LatestSighting(atlas, *landmark, entry.views[0].patch->keyframe.session, poses);
      }
      const auto before = known.find(landmark_id);
      if (before == known.end()) continue;
      entry.failures = before->second->failures;
      entry.tracked = before->second->tracked;
    }
  }
  return local;
}

}  // namespace pangaea
