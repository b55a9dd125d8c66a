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

// Where a keyframe goes.
struct Destination {
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

  // `moved` is the atlas after the edit of the keyframes.
  MoveLandmarks Landmarks(const Atlas& moved) const {
    std::vector<std::pair<LandmarkId, Eigen::Vector3d>> points;
    const std::unordered_set<KeyframeId> references = ReferencesOfCorrected();
    for (const KeyframeId id : tree_) {
      if (!destinations_.at(id).moves && !references.contains(id)) continue;
      for (const LandmarkId landmark : current_.FindKeyframe(id)->landmarks) {
        if (landmark.valid()) MoveLandmark(*current_.FindLandmark(landmark), id, moved, points);
      }
    }
    return MoveLandmarksTo(moved, points);
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
    const Destination stays{keyframe.camera_from_map};
    const auto corrected = corrected_keyframes_.find(keyframe.id);
    const Keyframe* before = InBase(keyframe.id);
    if (before != nullptr && corrected == corrected_keyframes_.end()) return stays;
    if (before != nullptr && !IsEdited(*before, keyframe)) {
      return {corrected->second->camera_from_map, corrected->second->scale, true};
    }
    const Keyframe* parent = current_.FindKeyframe(keyframe.parent);
    return parent == nullptr ? stays : Follow(*parent, keyframe);
  }

  Destination Follow(const Keyframe& parent, const Keyframe& keyframe) const {
    const Destination& ahead = destinations_.at(parent.id);
    if (!ahead.moves) return {keyframe.camera_from_map};
    const Rigid3d camera_from_parent = keyframe.camera_from_map * parent.camera_from_map.Inverse();
    return {ScaleLengths(camera_from_parent, ahead.scale) * ahead.camera_from_map, ahead.scale, true};
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

  bool IsEdited(const Landmark& now) const {
    const Landmark* before = correction_.base.FindLandmark(now.id);
    const Keyframe* reference_before = InBase(now.reference);
    if (before == nullptr || reference_before == nullptr || correction_.base.MapOf(*before) != correction_.map) {
      return true;
    }
    return !IsSame(reference_before->camera_from_map * before->point_in_map,
                   current_.FindKeyframe(now.reference)->camera_from_map * now.point_in_map);
  }

  // By its reference alone, so that each is moved once.
  void MoveLandmark(const Landmark& landmark, KeyframeId seen_from, const Atlas& moved,
                    std::vector<std::pair<LandmarkId, Eigen::Vector3d>>& points) const {
    if (landmark.reference != seen_from) return;
    const auto corrected = corrected_landmarks_.find(landmark.id);
    const Destination& reference = destinations_.at(seen_from);
    if (corrected != corrected_landmarks_.end() && !IsEdited(landmark)) {
      points.emplace_back(landmark.id, corrected->second->point_in_map);
    } else if (reference.moves) {
      const Eigen::Vector3d in_reference = current_.FindKeyframe(seen_from)->camera_from_map * landmark.point_in_map;
      const Rigid3d map_from_camera = moved.FindKeyframe(seen_from)->camera_from_map.Inverse();
      points.emplace_back(landmark.id, map_from_camera * (reference.scale * in_reference));
    }
  }

  const Correction& correction_;
  const Atlas& current_;
  const std::vector<KeyframeId> tree_;  // of the map as it is now, parents first
  std::unordered_map<KeyframeId, const CorrectedKeyframe*> corrected_keyframes_;
  std::unordered_map<LandmarkId, const CorrectedLandmark*> corrected_landmarks_;
  std::unordered_map<KeyframeId, Destination> destinations_;
};

}  // namespace

std::vector<MapEdit> Rebase(const Correction& correction, const Atlas& current) {
  std::vector<MapEdit> edits;
  const Rebasing rebasing(correction, current);
  MoveKeyframes keyframes = rebasing.Keyframes();
  Atlas moved = current;
  if (!keyframes.keyframes.empty()) {
    // A correction out of all bounds is none.
    if (!Apply(keyframes, moved)) return {};
    edits.emplace_back(std::move(keyframes));
  }
  MoveLandmarks landmarks = rebasing.Landmarks(moved);
  if (!landmarks.landmarks.empty()) edits.emplace_back(std::move(landmarks));
  return edits;
}

}  // namespace pangaea
