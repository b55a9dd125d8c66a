#include "server/optimization/correction.h"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "common/map/edits/reference_scale.h"
#include "common/map/map_edit.h"
#include "common/map/spanning_tree.h"

namespace pangaea {
namespace {

// Poses and points that differ by less, relatively, are the same: they were taken apart and composed again.
constexpr double kSame = 1e-9;

bool IsSame(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return (a - b).norm() <= kSame * std::max(1.0, a.norm());
}

bool IsSame(const Rigid3d& a, const Rigid3d& b) {
  return IsSame(a.translation(), b.translation()) && a.rotation().angularDistance(b.rotation()) <= kSame;
}

// Where a keyframe goes, and from where.
struct Destination {
  Rigid3d before;  // camera_from_map, and so is what follows
  Rigid3d camera_from_map;
  double scale = 1.0;
  bool moves = false;
};

class Rebasing {
 public:
  Rebasing(const Correction& correction, const Atlas& current)
      : correction_(correction), current_(current), tree_(ParentsFirst(current, correction.map)) {
    for (const CorrectedKeyframe& keyframe : correction.keyframes) corrected_keyframes_[keyframe.id] = &keyframe;
    for (const CorrectedLandmark& landmark : correction.landmarks) corrected_landmarks_[landmark.id] = &landmark;
    for (const KeyframeId id : tree_) destinations_[id] = Choose(*current.FindKeyframe(id));
  }

  MoveKeyframes Keyframes() const {
    std::vector<std::pair<KeyframeId, Rigid3d>> moved;
    for (const KeyframeId id : tree_) {
      const Destination& destination = destinations_.at(id);
      if (destination.moves) moved.emplace_back(id, destination.camera_from_map);
    }
    MoveKeyframes edit = MoveKeyframesTo(current_, moved);
    edit.correction = kProvisionalCorrection;
    for (MovedKeyframe& keyframe : edit.keyframes) {
      keyframe.scale = destinations_.at(keyframe.id).scale;
      // Measured on this very atlas, with what the references will be.
      keyframe.reference_scale = {};
    }
    return edit;
  }

  // Once the edit of the keyframes has been applied.
  MoveLandmarks Landmarks() const {
    std::vector<std::pair<LandmarkId, Eigen::Vector3d>> points;
    const std::unordered_set<KeyframeId> references = ReferencesOfCorrected();
    for (const KeyframeId id : tree_) {
      const Destination& destination = destinations_.at(id);
      if (destination.moves || references.contains(id)) MoveLandmarksOf(id, destination, points);
    }
    return MoveLandmarksTo(current_, points);
  }

 private:
  std::unordered_set<KeyframeId> ReferencesOfCorrected() const {
    std::unordered_set<KeyframeId> references;
    for (const auto& [id, corrected] : corrected_landmarks_) {
      const Landmark* landmark = current_.FindLandmark(id);
      if (landmark != nullptr) references.insert(landmark->reference);
    }
    return references;
  }

  Destination Choose(const Keyframe& keyframe) const {
    const Destination stays{keyframe.camera_from_map, keyframe.camera_from_map};
    const auto corrected = corrected_keyframes_.find(keyframe.id);
    const Keyframe* before = InBase(keyframe.id);
    if (before != nullptr && corrected == corrected_keyframes_.end()) return stays;
    if (before != nullptr && !IsEdited(*before, keyframe)) {
      return {keyframe.camera_from_map, corrected->second->camera_from_map, corrected->second->scale, true};
    }
    const Keyframe* parent = current_.FindKeyframe(keyframe.parent);
    return parent == nullptr ? stays : Follow(*parent, keyframe);
  }

  Destination Follow(const Keyframe& parent, const Keyframe& keyframe) const {
    const Destination& ahead = destinations_.at(parent.id);
    if (!ahead.moves) return {keyframe.camera_from_map, keyframe.camera_from_map};
    const Rigid3d camera_from_parent = keyframe.camera_from_map * parent.camera_from_map.Inverse();
    return {keyframe.camera_from_map, ScaleLengths(camera_from_parent, ahead.scale) * ahead.camera_from_map,
            ahead.scale, true};
  }

  const Keyframe* InBase(KeyframeId id) const {
    const Keyframe* keyframe = correction_.base.FindKeyframe(id);
    return keyframe != nullptr && keyframe->map == correction_.map ? keyframe : nullptr;
  }

  // The tree may hang together in another way by now: what counts is the keyframe above which the snapshot has too.
  bool IsEdited(const Keyframe& before, const Keyframe& now) const {
    for (const Keyframe* above = current_.FindKeyframe(now.parent); above != nullptr;
         above = current_.FindKeyframe(above->parent)) {
      const Keyframe* above_before = InBase(above->id);
      if (above_before == nullptr) continue;
      return !IsSame(before.camera_from_map * above_before->camera_from_map.Inverse(),
                     now.camera_from_map * above->camera_from_map.Inverse());
    }
    return !IsSame(before.camera_from_map, now.camera_from_map);
  }

  bool IsEdited(const Landmark& now, const Rigid3d& reference_from_map) const {
    const Landmark* before = correction_.base.FindLandmark(now.id);
    const Keyframe* reference_before = InBase(now.reference);
    if (before == nullptr || reference_before == nullptr || correction_.base.MapOf(*before) != correction_.map) {
      return true;
    }
    return !IsSame(reference_before->camera_from_map * before->point_in_map, reference_from_map * now.point_in_map);
  }

  // Of which it is the reference, so that each is moved once.
  void MoveLandmarksOf(KeyframeId id, const Destination& destination,
                       std::vector<std::pair<LandmarkId, Eigen::Vector3d>>& points) const {
    const Keyframe& moved = *current_.FindKeyframe(id);
    const Rigid3d map_from_camera = moved.camera_from_map.Inverse();
    for (const LandmarkId landmark_id : moved.landmarks) {
      if (!landmark_id.valid()) continue;
      const Landmark& landmark = *current_.FindLandmark(landmark_id);
      if (landmark.reference != id) continue;
      const auto corrected = corrected_landmarks_.find(landmark_id);
      if (corrected != corrected_landmarks_.end() && !IsEdited(landmark, destination.before)) {
        points.emplace_back(landmark_id, corrected->second->point_in_map);
      } else if (destination.moves) {
        const Eigen::Vector3d in_reference = destination.before * landmark.point_in_map;
        points.emplace_back(landmark_id, map_from_camera * (destination.scale * in_reference));
      }
    }
  }

  const Correction& correction_;
  const Atlas& current_;                // changes between Keyframes() and Landmarks()
  const std::vector<KeyframeId> tree_;  // of the map as it is now, parents first
  std::unordered_map<KeyframeId, const CorrectedKeyframe*> corrected_keyframes_;
  std::unordered_map<LandmarkId, const CorrectedLandmark*> corrected_landmarks_;
  std::unordered_map<KeyframeId, Destination> destinations_;
};

}  // namespace

Status Rebase(const Correction& correction, const Atlas& atlas, const std::function<Status(MapEdit)>& apply) {
  const Rebasing rebasing(correction, atlas);
  if (MoveKeyframes keyframes = rebasing.Keyframes(); !keyframes.keyframes.empty()) {
    if (auto status = apply(std::move(keyframes)); !status) return status;
  }
  MoveLandmarks landmarks = rebasing.Landmarks();
  return landmarks.landmarks.empty() ? Status() : apply(std::move(landmarks));
}

std::vector<MapEdit> Rebase(const Correction& correction, const Atlas& current) {
  Atlas draft = current;
  std::vector<MapEdit> edits;
  // A correction out of all bounds is none.
  (void)Rebase(correction, draft, [&](MapEdit edit) {
    Status status = Apply(edit, draft);
    if (status) edits.push_back(std::move(edit));
    return status;
  });
  return edits;
}

}  // namespace pangaea
