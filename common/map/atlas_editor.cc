#include "common/map/atlas_editor.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "common/base/check.h"

namespace pangaea {
namespace {

// `others` ascend. Each is looked for behind the one before.
void ChangeWeights(std::vector<Covisibility>& covisible, std::span<const Observation> others, int change) {
  auto edge = covisible.begin();
  for (const Observation& other : others) {
    edge = std::lower_bound(edge, covisible.end(), other.keyframe,
                            [](const Covisibility& c, KeyframeId id) { return c.keyframe < id; });
    if (edge == covisible.end() || edge->keyframe != other.keyframe) edge = covisible.insert(edge, {other.keyframe, 0});
    edge->weight = static_cast<std::uint32_t>(static_cast<std::int64_t>(edge->weight) + change);
    if (edge->weight == 0) edge = covisible.erase(edge);
  }
}

bool IsObservedFrom(std::span<const Observation> observations, KeyframeId keyframe) {
  return std::ranges::binary_search(observations, keyframe, {}, &Observation::keyframe);
}

auto FindObservation(std::vector<Observation>& observations, KeyframeId keyframe) {
  return std::lower_bound(observations.begin(), observations.end(), keyframe,
                          [](const Observation& o, KeyframeId id) { return o.keyframe < id; });
}

bool StampOrder(const FramePose& a, const FramePose& b) {
  return std::pair(a.stamp_ns, a.session) < std::pair(b.stamp_ns, b.session);
}

template <typename Count>
void Change(Count& count, int change) {
  count = static_cast<Count>(static_cast<std::int64_t>(count) + change);
}

}  // namespace

Atlas::Part& AtlasEditor::WritePart(SessionId session) {
  auto& parts = atlas_.parts_;
  auto part = std::lower_bound(parts.begin(), parts.end(), session,
                               [](const Atlas::Part& p, SessionId id) { return p.session < id; });
  if (part == parts.end() || part->session != session) {
    part = parts.emplace(part);
    part->session = session;
  }
  return *part;
}

Atlas::KeyframeSlot& AtlasEditor::WriteSlot(KeyframeId id) {
  return WritePart(id.session).keyframes.Write(id.counter, atlas_.mark_);
}

Atlas::LandmarkSlot& AtlasEditor::WriteSlot(LandmarkId id) {
  return WritePart(id.session).landmarks.Write(id.counter, atlas_.mark_);
}

Keyframe& AtlasEditor::WriteKeyframe(KeyframeId id) {
  auto* keyframe = std::get_if<CopyOnWrite<Keyframe>>(&WriteSlot(id));
  PANGAEA_CHECK(keyframe != nullptr);
  return keyframe->Write(atlas_.mark_);
}

Landmark& AtlasEditor::WriteLandmark(LandmarkId id) {
  auto* landmark = std::get_if<Landmark>(&WriteSlot(id));
  PANGAEA_CHECK(landmark != nullptr);
  return *landmark;
}

MapInfo& AtlasEditor::WriteMap(MapId id) { return atlas_.maps_.Write(atlas_.mark_).living.at(id); }

void AtlasEditor::CountKeyframe(const Keyframe& keyframe, int change) {
  Change(WriteMap(keyframe.map).keyframes, change);
  Change(WritePart(keyframe.id.session).keyframe_count, change);
  Change(atlas_.keyframe_count_, change);
}

void AtlasEditor::CountLandmark(LandmarkId id, MapId map, int change) {
  Change(WriteMap(map).landmarks, change);
  Change(WritePart(id.session).landmark_count, change);
  Change(atlas_.landmark_count_, change);
}

void AtlasEditor::InsertKeyframe(Keyframe keyframe) {
  const KeyframeId id = keyframe.id;
  const KeyframeId parent = std::exchange(keyframe.parent, KeyframeId{});
  if (!parent.valid()) {
    MapInfo info;
    info.id = keyframe.map;
    info.root = id;
    atlas_.maps_.Write(atlas_.mark_).living.emplace(info.id, info);
  }
  CountKeyframe(keyframe, +1);
  CopyOnWrite<Keyframe> node;
  node.Write(atlas_.mark_) = std::move(keyframe);
  WriteSlot(id) = std::move(node);
  if (parent.valid()) SetParent(id, parent);
}

void AtlasEditor::InsertLandmark(LandmarkId id, const Eigen::Vector3d& point_in_map, KeyframeId reference,
                                 std::uint32_t keypoint) {
  WriteSlot(id) = Landmark{id, point_in_map, reference, {}};
  CountLandmark(id, atlas_.FindKeyframe(reference)->map, +1);
  Observe(id, reference, keypoint);
}

void AtlasEditor::InsertObserved(Landmark landmark) {
  for (const Observation& observation : landmark.observations) {
    WriteKeyframe(observation.keyframe).landmarks.at(observation.keypoint) = landmark.id;
  }
  CountLandmark(landmark.id, atlas_.FindKeyframe(landmark.reference)->map, +1);
  WriteSlot(landmark.id) = std::move(landmark);
}

void AtlasEditor::ChangeCovisibility(std::span<const Observation> some, std::span<const Observation> others,
                                     int change) {
  for (const Observation& observer : some) ChangeWeights(WriteKeyframe(observer.keyframe).covisible, others, change);
  for (const Observation& other : others) ChangeWeights(WriteKeyframe(other.keyframe).covisible, some, change);
}

void AtlasEditor::Observe(LandmarkId landmark, KeyframeId keyframe, std::uint32_t keypoint) {
  auto& observations = WriteLandmark(landmark).observations;
  const Observation observation{keyframe, keypoint};
  ChangeCovisibility({&observation, 1}, observations, +1);
  observations.insert(FindObservation(observations, keyframe), observation);
  WriteKeyframe(keyframe).landmarks.at(keypoint) = landmark;
}

Observation AtlasEditor::TakeObservation(LandmarkId landmark, KeyframeId keyframe) {
  Landmark& from = WriteLandmark(landmark);
  const auto found = FindObservation(from.observations, keyframe);
  PANGAEA_CHECK(found != from.observations.end() && found->keyframe == keyframe);
  const Observation observation = *found;
  from.observations.erase(found);
  if (from.observations.empty()) {
    EraseLandmark(landmark, atlas_.FindKeyframe(keyframe)->map);
  } else if (from.reference == keyframe) {
    from.reference = from.observations.front().keyframe;
  }
  return observation;
}

void AtlasEditor::Unobserve(LandmarkId landmark, KeyframeId keyframe) {
  const Observation observation = TakeObservation(landmark, keyframe);
  WriteKeyframe(keyframe).landmarks.at(observation.keypoint) = {};
  const Landmark* rest = atlas_.FindLandmark(landmark);
  if (rest != nullptr) ChangeCovisibility({&observation, 1}, rest->observations, -1);
}

// Its edges go whole, instead of by one for each landmark.
void AtlasEditor::UnobserveAll(KeyframeId id) {
  Keyframe& keyframe = WriteKeyframe(id);
  const std::vector<LandmarkId> landmarks = keyframe.landmarks;
  std::ranges::fill(keyframe.landmarks, LandmarkId{});
  for (const Covisibility& edge : std::exchange(keyframe.covisible, {})) {
    auto& of_other = WriteKeyframe(edge.keyframe).covisible;
    of_other.erase(std::ranges::lower_bound(of_other, id, {}, &Covisibility::keyframe));
  }
  for (const LandmarkId landmark : landmarks) {
    if (landmark.valid()) (void)TakeObservation(landmark, id);
  }
}

void AtlasEditor::EraseLandmark(LandmarkId id, MapId map) {
  WriteSlot(id) = Atlas::Gone{};
  CountLandmark(id, map, -1);
}

void AtlasEditor::RemoveLandmark(LandmarkId id) {
  const std::vector<Observation> observations = atlas_.FindLandmark(id)->observations;
  for (const Observation& observation : observations) Unobserve(id, observation.keyframe);
}

// Two keyframes share one landmark more where each saw one of the two alone, and one less where both saw both.
void AtlasEditor::Fuse(LandmarkId kept_id, LandmarkId absorbed_id) {
  const std::vector<Observation> absorbed = atlas_.FindLandmark(absorbed_id)->observations;
  Landmark& kept = WriteLandmark(kept_id);
  std::vector<Observation> of_absorbed_alone, of_both, of_kept_alone;
  for (const Observation& observation : absorbed) {
    const bool both = IsObservedFrom(kept.observations, observation.keyframe);
    (both ? of_both : of_absorbed_alone).push_back(observation);
    WriteKeyframe(observation.keyframe).landmarks.at(observation.keypoint) = both ? LandmarkId{} : kept_id;
  }
  std::ranges::copy_if(kept.observations, std::back_inserter(of_kept_alone),
                       [&](const Observation& o) { return !IsObservedFrom(absorbed, o.keyframe); });
  ChangeCovisibility(of_absorbed_alone, of_kept_alone, +1);
  for (std::size_t i = 0; i < of_both.size(); ++i) {
    ChangeCovisibility({&of_both[i], 1}, std::span(of_both).subspan(i + 1), -1);
  }
  for (const Observation& observation : of_absorbed_alone) {
    kept.observations.insert(FindObservation(kept.observations, observation.keyframe), observation);
  }
  EraseLandmark(absorbed_id, atlas_.FindKeyframe(kept.reference)->map);
  ForwardLandmark(absorbed_id, kept_id);
}

void AtlasEditor::ForwardLandmark(LandmarkId id, LandmarkId absorber) { WriteSlot(id) = absorber; }

void AtlasEditor::ForgetLandmark(LandmarkId id) { WriteSlot(id) = Atlas::Gone{}; }

void AtlasEditor::SetParent(KeyframeId id, KeyframeId parent) {
  const KeyframeId old_parent = std::exchange(WriteKeyframe(id).parent, parent);
  if (old_parent.valid()) std::erase(WriteKeyframe(old_parent).children, id);
  if (!parent.valid()) return;
  auto& children = WriteKeyframe(parent).children;
  children.insert(std::lower_bound(children.begin(), children.end(), id), id);
}

void AtlasEditor::RemoveKeyframe(KeyframeId id) {
  const Keyframe& keyframe = WriteKeyframe(id);
  const MapId map = keyframe.map;
  CountKeyframe(keyframe, -1);
  if (!keyframe.parent.valid()) {
    atlas_.maps_.Write(atlas_.mark_).living.erase(map);
    return WriteFormerKeyframe(id, nullptr);
  }
  const Keyframe& parent = *atlas_.FindKeyframe(keyframe.parent);
  const CulledKeyframe culled{keyframe.parent, parent.camera_from_map * keyframe.camera_from_map.Inverse()};
  RehangLoopEdges(id, culled);
  SetParent(id, {});
  WriteFormerKeyframe(id, &culled);
}

void AtlasEditor::RehangLoopEdges(KeyframeId id, const CulledKeyframe& culled) {
  const auto touches = [&](const LoopEdge& edge) { return edge.from == id || edge.to == id; };
  const auto& present = atlas_.loop_edges();
  if (std::none_of(present.begin(), present.end(), touches)) return;
  const Similarity3d parent_from_culled(culled.parent_from_culled);
  for (LoopEdge& edge : WriteLoopEdges()) {
    if (edge.from == id) edge = {culled.parent, edge.to, edge.to_from_from * parent_from_culled.Inverse()};
    if (edge.to == id) edge = {edge.from, culled.parent, parent_from_culled * edge.to_from_from};
  }
  std::erase_if(WriteLoopEdges(), [](const LoopEdge& edge) { return edge.from == edge.to; });
}

void AtlasEditor::WriteFormerKeyframe(KeyframeId id, const CulledKeyframe* culled) {
  if (culled != nullptr) {
    WriteSlot(id) = *culled;
  } else {
    WriteSlot(id) = Atlas::Gone{};
  }
}

void AtlasEditor::InsertFrames(KeyframeId id, std::span<const FramePose> frames) {
  Keyframe& keyframe = WriteKeyframe(id);
  auto all = std::make_shared<std::vector<FramePose>>();
  // No more than it takes: there are 72,000 in an hour, in every copy of the map.
  all->reserve((keyframe.frames ? keyframe.frames->size() : 0) + frames.size());
  if (keyframe.frames) all->assign(keyframe.frames->begin(), keyframe.frames->end());
  for (const FramePose& frame : frames) {
    const auto place = std::lower_bound(all->begin(), all->end(), frame, StampOrder);
    if (place != all->end() && !StampOrder(frame, *place)) {
      *place = frame;
    } else {
      all->insert(place, frame);
    }
  }
  keyframe.frames = std::move(all);
}

void AtlasEditor::ForwardMap(MapId absorbed, MapId survivor) {
  auto& maps = atlas_.maps_.Write(atlas_.mark_);
  maps.living.erase(absorbed);
  maps.merged[absorbed] = survivor;
}

std::vector<LoopEdge>& AtlasEditor::WriteLoopEdges() { return atlas_.loop_edges_.Write(atlas_.mark_); }

}  // namespace pangaea
