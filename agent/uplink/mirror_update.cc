#include "agent/uplink/mirror_update.h"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "agent/absorption/absorption.h"
#include "agent/uplink/digest_grid.h"
#include "agent/uplink/pose_distance.h"
#include "common/map/map_edit.h"
#include "common/map/spanning_tree.h"

namespace pangaea {
namespace {

// Larger lists are split, so that no single edit outgrows an envelope.
constexpr std::size_t kMostMoves = 2000;

template <typename Item, typename Take>
void InChunks(const std::vector<Item>& items, Take take) {
  for (std::size_t begin = 0; begin < items.size(); begin += kMostMoves) {
    take(std::span<const Item>(items).subspan(begin, std::min(kMostMoves, items.size() - begin)));
  }
}

}  // namespace

bool MirrorUpdate::Emit(MapEdit edit) {
  if (!Apply(edit, mirror_)) return false;
  edits_.push_back(std::move(edit));
  return true;
}

std::vector<KeyframeId> MirrorUpdate::AddKeyframes(const std::vector<KeyframeId>& keyframes) {
  std::vector<KeyframeId> missing;
  for (KeyframeId id : keyframes) {
    for (const Keyframe* keyframe = agent_.FindKeyframe(id);
         keyframe != nullptr && IsOwn(id) && !mirror_.FindKeyframe(id); keyframe = agent_.FindKeyframe(id)) {
      missing.push_back(id);
      id = keyframe->parent;
    }
  }
  missing = ParentsFirst(agent_, missing);
  std::vector<KeyframeId> added;
  for (const KeyframeId id : missing) {
    const Keyframe& keyframe = *agent_.FindKeyframe(id);
    const Keyframe* parent = ParentInMirror(keyframe);
    const KeyframeId parent_id = parent == nullptr ? keyframe.parent : parent->id;
    const Rigid3d camera_from_parent =
        parent == nullptr ? keyframe.camera_from_map : keyframe.camera_from_map * parent->camera_from_map.Inverse();
    const ReferenceScale scale{parent == nullptr ? 1.0 : parent->scale};
    const bool taken = Emit(AddKeyframe{id, keyframe.map, parent_id, camera_from_parent, keyframe.data, scale});
    if (taken) added.push_back(id);
  }
  return added;
}

// A root that the agent culled before its heir was sent is still the mirror's: the heir hangs below it until it goes.
const Keyframe* MirrorUpdate::ParentInMirror(const Keyframe& keyframe) const {
  if (keyframe.parent.valid()) return mirror_.FindKeyframe(keyframe.parent);
  const MapInfo* map = mirror_.FindMap(keyframe.map);
  return map == nullptr ? nullptr : mirror_.FindKeyframe(map->root);
}

std::vector<LandmarkId> MirrorUpdate::RemoveKeyframes(const std::set<KeyframeId>& culled) {
  std::vector<LandmarkId> observed;
  std::vector<KeyframeId> present;
  for (const KeyframeId id : culled) {
    if (IsOwn(id) && mirror_.FindKeyframe(id) != nullptr && agent_.FindKeyframe(id) == nullptr) present.push_back(id);
  }
  present = ParentsFirst(mirror_, present);
  std::reverse(present.begin(), present.end());  // a root goes last
  for (const KeyframeId id : present) {
    for (const LandmarkId landmark : mirror_.FindKeyframe(id)->landmarks) {
      if (landmark.valid()) observed.push_back(landmark);
    }
    Emit(RemoveKeyframe{id});
  }
  return observed;
}

void MirrorUpdate::SetVergence() {
  std::optional<double> vergence;
  mirror_.ForEachKeyframe(session_, [&](const Keyframe& present) {
    const Keyframe* wanted = agent_.FindKeyframe(present.id);
    if (wanted != nullptr && wanted->data->vergence != present.data->vergence) vergence = wanted->data->vergence;
  });
  if (vergence) Emit(pangaea::SetVergence{session_, *vergence});
}

void MirrorUpdate::MoveKeyframes(const std::set<KeyframeId>& keyframes, const MoveThresholds& thresholds) {
  std::vector<std::pair<KeyframeId, Rigid3d>> moved;
  for (const KeyframeId id : keyframes) {
    const Keyframe* wanted = agent_.FindKeyframe(id);
    const Keyframe* present = mirror_.FindKeyframe(id);
    if (wanted == nullptr || present == nullptr || IsReadOnly(*present, session_)) continue;
    const PoseDistance distance = DistanceOf(wanted->camera_from_map, present->camera_from_map);
    const bool far = distance.center_m > thresholds.keyframe_m || distance.angle_rad > thresholds.keyframe_rad;
    const bool told_apart = thresholds.digest_grid && !OnSameGrid(wanted->camera_from_map, present->camera_from_map);
    if (far || told_apart) moved.emplace_back(id, wanted->camera_from_map);
  }
  if (!moved.empty()) Emit(MoveKeyframesTo(mirror_, moved));
}

void MirrorUpdate::MoveLandmarks(const std::set<LandmarkId>& landmarks, const MoveThresholds& thresholds) {
  std::vector<std::pair<LandmarkId, Eigen::Vector3d>> moved;
  for (const LandmarkId id : landmarks) {
    const Landmark* wanted = agent_.FindLandmark(id);
    const Landmark* present = mirror_.FindLandmark(id);
    if (wanted == nullptr || present == nullptr || IsReadOnly(mirror_, *present, session_)) continue;
    const Keyframe& reference = *mirror_.FindKeyframe(present->reference);
    const double range_m = (reference.camera_from_map * present->point_in_map).norm();
    const double threshold_m = std::max(thresholds.landmark_m, thresholds.landmark_fraction * range_m);
    const bool far = (wanted->point_in_map - present->point_in_map).norm() > threshold_m;
    const bool told_apart = thresholds.digest_grid && !OnSameGrid(wanted->point_in_map, present->point_in_map);
    if (far || told_apart) moved.emplace_back(id, wanted->point_in_map);
  }
  InChunks(moved, [this](auto chunk) {
    auto edit = MoveLandmarksTo(mirror_, chunk);
    if (!edit.landmarks.empty()) Emit(std::move(edit));
  });
}

void MirrorUpdate::AddFrames(const std::set<KeyframeId>& keyframes, const MoveThresholds& thresholds) {
  std::vector<TrackedFrame> missing;
  for (const KeyframeId id : keyframes) {
    const Keyframe* wanted = agent_.FindKeyframe(id);
    const Keyframe* present = mirror_.FindKeyframe(id);
    if (!IsOwn(id) || wanted == nullptr || present == nullptr || wanted->frames == nullptr) continue;
    for (const FramePose& frame : *wanted->frames) {
      if (frame.session != session_) continue;  // of a guest that was culled: not for this agent to say
      if (!HoldsFrame(*present, frame, thresholds.keyframe_m, thresholds.keyframe_rad))
        missing.push_back({id, frame, {present->scale}});
    }
  }
  std::stable_sort(missing.begin(), missing.end(),
                   [](const TrackedFrame& a, const TrackedFrame& b) { return a.pose.stamp_ns < b.pose.stamp_ns; });
  AddFramePoses edit;
  for (TrackedFrame& frame : missing) {
    // Stamps ascend strictly within an edit; two keyframes may hold frames of one stamp.
    const bool follows = edit.frames.empty() || edit.frames.back().pose.stamp_ns < frame.pose.stamp_ns;
    if (!follows || edit.frames.size() >= kMostMoves) Emit(std::exchange(edit, {}));
    edit.frames.push_back(std::move(frame));
  }
  if (!edit.frames.empty()) Emit(std::move(edit));
}

void MirrorUpdate::AddLoopEdges() {
  const auto holds = [this](const LoopEdge& edge) {
    const auto& edges = mirror_.loop_edges();
    return std::any_of(edges.begin(), edges.end(),
                       [&](const LoopEdge& e) { return e.from == edge.from && e.to == edge.to; });
  };
  for (const LoopEdge& edge : agent_.loop_edges()) {
    if (mirror_.FindKeyframe(edge.from) == nullptr || mirror_.FindKeyframe(edge.to) == nullptr || holds(edge)) continue;
    Emit(AddLoopEdge{edge.from, edge.to, edge.to_from_from});
  }
}

void MirrorUpdate::CloseMaps(const std::set<KeyframeId>& unsent) {
  std::set<MapId> growing;
  for (const KeyframeId id : unsent) {
    if (const Keyframe* keyframe = agent_.FindKeyframe(id)) growing.insert(keyframe->map);
  }
  for (const MapId id : agent_.Maps()) {
    if (!IsOwn(id) || growing.contains(id)) continue;
    const MapInfo* present = mirror_.FindMap(id);
    if (present != nullptr && !present->closed && agent_.FindMap(id)->closed) Emit(CloseMap{id});
  }
}

}  // namespace pangaea
