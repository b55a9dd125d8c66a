#include "server/fusion/welding_draft.h"

#include "common/map/map_edit.h"
#include "common/map/spanning_tree.h"

namespace pangaea {

void WeldingDraft::Change(const MapEdit& edit) {
  // What was found in the welded atlas is as true in the other: they differ in where things are, not in what is.
  if (!Apply(edit, welded_) || !Apply(edit, structure_)) return;
  edits_.push_back(edit);
}

void WeldingDraft::Change(const std::vector<MapEdit>& edits) {
  for (const MapEdit& edit : edits) Change(edit);
}

void WeldingDraft::Transform(const std::vector<KeyframeId>& keyframes, const std::vector<LandmarkId>& landmarks,
                             const Similarity3d& target_from_map) {
  std::vector<std::pair<KeyframeId, Rigid3d>> poses;
  std::vector<std::pair<LandmarkId, Eigen::Vector3d>> points;
  for (const KeyframeId id : keyframes) {
    poses.emplace_back(id, target_from_map.TransformCamera(welded_.FindKeyframe(id)->camera_from_map));
    moved_keyframes_.try_emplace(id, 1.0).first->second *= target_from_map.scale();
  }
  for (const LandmarkId id : landmarks) {
    points.emplace_back(id, target_from_map * welded_.FindLandmark(id)->point_in_map);
  }
  Move(poses, std::move(points));
}

void WeldingDraft::Move(const std::vector<std::pair<KeyframeId, Rigid3d>>& camera_from_map,
                        std::vector<std::pair<LandmarkId, Eigen::Vector3d>> point_in_map) {
  std::set<LandmarkId> named;
  for (const auto& [id, point] : point_in_map) named.insert(id);
  for (const auto& [id, pose] : camera_from_map) {
    const Keyframe& keyframe = *welded_.FindKeyframe(id);
    for (const LandmarkId landmark_id : keyframe.landmarks) {
      if (!landmark_id.valid() || named.contains(landmark_id)) continue;
      const Landmark& landmark = *welded_.FindLandmark(landmark_id);
      if (landmark.reference != id) continue;
      point_in_map.emplace_back(landmark_id, pose.Inverse() * (keyframe.camera_from_map * landmark.point_in_map));
    }
    moved_keyframes_.try_emplace(id, 1.0);
  }
  for (const auto& [id, point] : point_in_map) moved_landmarks_.insert(id);
  (void)Apply(MoveKeyframesTo(welded_, camera_from_map), welded_);
  (void)Apply(MoveLandmarksTo(welded_, point_in_map), welded_);
}

Correction WeldingDraft::Moves(MapId map) const {
  Correction correction{.base = structure_, .map = map, .keyframes = {}, .landmarks = {}};
  for (const auto& [id, scale] : moved_keyframes_) {
    const Keyframe* keyframe = welded_.FindKeyframe(id);
    if (keyframe != nullptr) correction.keyframes.push_back({id, keyframe->camera_from_map, scale});
  }
  for (const LandmarkId id : moved_landmarks_) {
    const Landmark* landmark = welded_.FindLandmark(id);
    if (landmark != nullptr) correction.landmarks.push_back({id, landmark->point_in_map});
  }
  return correction;
}

}  // namespace pangaea
