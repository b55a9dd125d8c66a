#include "server/fusion/welding_draft.h"

#include "common/map/map_edit.h"
#include "common/map/spanning_tree.h"

namespace pangaea {

void WeldingDraft::Merge(const MergeMaps& edit) {
  Change(edit);
  base_ = welded_;
}

void WeldingDraft::Change(const MapEdit& edit) {
  if (Apply(edit, welded_)) edits_.push_back(edit);
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
  LandmarkIdSet named;
  for (const auto& [id, point] : point_in_map) named.Insert(id);
  for (const auto& [id, pose] : camera_from_map) {
    const Keyframe& keyframe = *welded_.FindKeyframe(id);
    for (const LandmarkId landmark_id : keyframe.landmarks) {
      if (!landmark_id.valid() || named.Contains(landmark_id)) continue;
      const Landmark& landmark = *welded_.FindLandmark(landmark_id);
      if (landmark.reference != id) continue;
      point_in_map.emplace_back(landmark_id, pose.Inverse() * (keyframe.camera_from_map * landmark.point_in_map));
    }
    moved_keyframes_.try_emplace(id, 1.0);
  }
  for (const auto& [id, point] : point_in_map) moved_landmarks_.Insert(id);
  MoveKeyframes moves = MoveKeyframesTo(welded_, camera_from_map);
  // Moves of an agent would leave those alone that a correction has placed before.
  moves.correction = kProvisionalCorrection;
  (void)Apply(moves, welded_);
  (void)Apply(MoveLandmarksTo(welded_, point_in_map), welded_);
}

void WeldingDraft::MovePoint(LandmarkId id, const Eigen::Vector3d& point_in_map) {
  moved_landmarks_.Insert(id);
  const std::pair<LandmarkId, Eigen::Vector3d> moved(id, point_in_map);
  (void)Apply(MoveLandmarksTo(welded_, {&moved, 1}), welded_);
}

Correction WeldingDraft::Moves(MapId map) const {
  Correction correction{.base = base_, .map = map, .keyframes = {}, .landmarks = {}};
  for (const auto& [id, scale] : moved_keyframes_) {
    const Keyframe* keyframe = welded_.FindKeyframe(id);
    if (keyframe != nullptr) correction.keyframes.push_back({id, keyframe->camera_from_map, scale});
  }
  for (const LandmarkId id : moved_landmarks_.Ascending()) {
    const Landmark* landmark = welded_.FindLandmark(id);
    if (landmark != nullptr) correction.landmarks.push_back({id, landmark->point_in_map});
  }
  return correction;
}

}  // namespace pangaea
