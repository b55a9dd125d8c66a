#include "common/map/spanning_tree.h"

#include <algorithm>
#include <unordered_map>

#include "common/map/edits/point_form.h"
#include "common/map/limits.h"

namespace pangaea {
namespace {

KeyframeId ParentOf(const Atlas& atlas, KeyframeId id) {
  const Keyframe* keyframe = atlas.FindKeyframe(id);
  return keyframe == nullptr ? KeyframeId{} : keyframe->parent;
}

}  // namespace

std::size_t TreeDepth(const Atlas& atlas, KeyframeId id) {
  std::size_t depth = 0;
  while ((id = ParentOf(atlas, id)).valid()) ++depth;
  return depth;
}

bool IsAncestorOrSelf(const Atlas& atlas, KeyframeId ancestor, KeyframeId id) {
  while (id.valid() && id != ancestor) id = ParentOf(atlas, id);
  return id.valid();
}

std::vector<KeyframeId> ParentsFirst(const Atlas& atlas, MapId map) {
  std::vector<KeyframeId> order;
  const MapInfo* info = atlas.FindMap(map);
  if (info == nullptr) return order;
  order.reserve(info->keyframes);
  order.push_back(info->root);
  for (std::size_t next = 0; next < order.size(); ++next) {
    const auto& children = atlas.FindKeyframe(order[next])->children;
    order.insert(order.end(), children.begin(), children.end());
  }
  return order;
}

std::vector<KeyframeId> ParentsFirst(const Atlas& atlas, std::span<const KeyframeId> keyframes) {
  std::vector<std::pair<std::size_t, KeyframeId>> by_depth;
  for (const KeyframeId id : keyframes) {
    if (atlas.FindKeyframe(id) != nullptr) by_depth.emplace_back(TreeDepth(atlas, id), id);
  }
  std::sort(by_depth.begin(), by_depth.end());
  by_depth.erase(std::unique(by_depth.begin(), by_depth.end()), by_depth.end());
  std::vector<KeyframeId> order;
  order.reserve(by_depth.size());
  for (const auto& [depth, id] : by_depth) order.push_back(id);
  return order;
}

MoveKeyframes MoveKeyframesTo(const Atlas& atlas, std::span<const std::pair<KeyframeId, Rigid3d>> camera_from_map) {
  std::unordered_map<KeyframeId, Rigid3d> target;
  std::vector<KeyframeId> ids;
  for (const auto& [id, pose] : camera_from_map) {
    target[id] = pose;
    ids.push_back(id);
  }
  MoveKeyframes edit;
  for (const KeyframeId id : ParentsFirst(atlas, ids)) {
    const Keyframe* parent = atlas.FindKeyframe(ParentOf(atlas, id));
    Rigid3d& pose = target.at(id);
    if (parent == nullptr) {
      edit.keyframes.push_back({id, pose, {}, {}});
      continue;
    }
    const auto moved = target.find(parent->id);
    const Rigid3d& parent_from_map = moved == target.end() ? parent->camera_from_map : moved->second;
    edit.keyframes.push_back({id, pose * parent_from_map.Inverse(), parent->id, {parent->scale}});
    // To the last bit what Apply will make of it: the pose against which the children are measured.
    pose = edit.keyframes.back().camera_from_reference * parent_from_map;
  }
  return edit;
}

MoveLandmarks MoveLandmarksTo(const Atlas& atlas,
                              std::span<const std::pair<LandmarkId, Eigen::Vector3d>> point_in_map) {
  MoveLandmarks edit;
  edit.landmarks.reserve(point_in_map.size());
  for (const auto& [id, point] : point_in_map) {
    const Landmark* landmark = atlas.FindLandmark(id);
    if (landmark == nullptr) continue;
    const Keyframe& reference = *atlas.FindKeyframe(landmark->reference);
    const Eigen::Vector3d point_in_reference = QuantizePoint(reference.camera_from_map * point);
    if (point_in_reference.z() > 0.0 && point_in_reference.norm() <= kMaxLength) {
      edit.landmarks.push_back({id, point_in_reference, reference.id, {reference.scale}});
    }
  }
  return edit;
}

}  // namespace pangaea
