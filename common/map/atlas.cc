#include "common/map/atlas.h"

#include <algorithm>

namespace pangaea {
const Atlas::Part* Atlas::FindPart(SessionId session) const {
  const auto part = std::lower_bound(parts_.begin(), parts_.end(), session,
                                     [](const Part& p, SessionId wanted) { return p.session < wanted; });
  return part != parts_.end() && part->session == session ? &*part : nullptr;
}

const Atlas::KeyframeSlot* Atlas::FindSlot(KeyframeId id) const {
  const Part* part = FindPart(id.session);
  return part == nullptr ? nullptr : part->keyframes.Find(id.counter);
}

const Atlas::LandmarkSlot* Atlas::FindSlot(LandmarkId id) const {
  const Part* part = FindPart(id.session);
  return part == nullptr ? nullptr : part->landmarks.Find(id.counter);
}

const Keyframe* Atlas::Living(const KeyframeSlot& slot) {
  const auto* keyframe = std::get_if<CopyOnWrite<Keyframe>>(&slot);
  return keyframe == nullptr ? nullptr : keyframe->get();
}

const Keyframe* Atlas::FindKeyframe(KeyframeId id) const {
  const KeyframeSlot* slot = FindSlot(id);
  return slot == nullptr ? nullptr : Living(*slot);
}

const Landmark* Atlas::FindLandmark(LandmarkId id) const {
  const LandmarkSlot* slot = FindSlot(id);
  return slot == nullptr ? nullptr : std::get_if<Landmark>(slot);
}

const MapInfo* Atlas::FindMap(MapId id) const {
  const MapTable* maps = maps_.get();
  if (maps == nullptr) return nullptr;
  const auto found = maps->living.find(id);
  return found == maps->living.end() ? nullptr : &found->second;
}

const CulledKeyframe* Atlas::FindCulled(KeyframeId id) const {
  const KeyframeSlot* slot = FindSlot(id);
  return slot == nullptr ? nullptr : std::get_if<CulledKeyframe>(slot);
}

KeyframeId Atlas::Resolve(KeyframeId id) const {
  while (const CulledKeyframe* culled = FindCulled(id)) id = culled->parent;
  return FindKeyframe(id) == nullptr ? KeyframeId{} : id;
}

std::optional<ResolvedKeyframe> Atlas::ResolvePose(KeyframeId id) const {
  Rigid3d current_from_asked;
  while (const CulledKeyframe* culled = FindCulled(id)) {
    current_from_asked = culled->parent_from_culled * current_from_asked;
    id = culled->parent;
  }
  const Keyframe* keyframe = FindKeyframe(id);
  if (keyframe == nullptr) return std::nullopt;
  return ResolvedKeyframe{keyframe, current_from_asked};
}

LandmarkId Atlas::Resolve(LandmarkId id) const {
  for (const LandmarkSlot* slot = FindSlot(id); slot != nullptr; slot = FindSlot(id)) {
    if (std::holds_alternative<Landmark>(*slot)) return id;
    const LandmarkId* absorber = std::get_if<LandmarkId>(slot);
    if (absorber == nullptr) break;
    id = *absorber;
  }
  return {};
}

MapId Atlas::Resolve(MapId id) const {
  const auto& merged = merged_maps();
  for (auto found = merged.find(id); found != merged.end(); found = merged.find(id)) id = found->second;
  return FindMap(id) == nullptr ? MapId{} : id;
}

bool Atlas::Knows(KeyframeId id) const {
  const KeyframeSlot* slot = FindSlot(id);
  return slot != nullptr && !std::holds_alternative<std::monostate>(*slot);
}

bool Atlas::Knows(LandmarkId id) const {
  const LandmarkSlot* slot = FindSlot(id);
  return slot != nullptr && !std::holds_alternative<std::monostate>(*slot);
}

MapId Atlas::MapOf(const Landmark& landmark) const {
  const Keyframe* reference = FindKeyframe(landmark.reference);
  return reference == nullptr ? MapId{} : reference->map;
}

std::vector<MapId> Atlas::Maps() const {
  std::vector<MapId> ids;
  if (maps_.get() == nullptr) return ids;
  for (const auto& [id, info] : maps_.get()->living) ids.push_back(id);
  return ids;
}

std::vector<SessionId> Atlas::Sessions() const {
  std::vector<SessionId> ids;
  for (const Part& part : parts_) ids.push_back(part.session);
  return ids;
}

void Atlas::ForEachKeyframe(const std::function<void(const Keyframe&)>& visit) const {
  for (const Part& part : parts_) ForEachKeyframe(part.session, visit);
}

void Atlas::ForEachLandmark(const std::function<void(const Landmark&)>& visit) const {
  for (const Part& part : parts_) ForEachLandmark(part.session, visit);
}

void Atlas::ForEachKeyframe(SessionId session, const std::function<void(const Keyframe&)>& visit) const {
  const Part* part = FindPart(session);
  if (part == nullptr) return;
  part->keyframes.ForEach([&](std::uint32_t, const KeyframeSlot& slot) {
    if (const Keyframe* keyframe = Living(slot)) visit(*keyframe);
  });
}

void Atlas::ForEachLandmark(SessionId session, const std::function<void(const Landmark&)>& visit) const {
  const Part* part = FindPart(session);
  if (part == nullptr) return;
  part->landmarks.ForEach([&](std::uint32_t, const LandmarkSlot& slot) {
    if (const auto* landmark = std::get_if<Landmark>(&slot)) visit(*landmark);
  });
}

void Atlas::ForEachFormerKeyframe(const std::function<void(KeyframeId, const CulledKeyframe*)>& visit) const {
  for (const Part& part : parts_) {
    part.keyframes.ForEach([&](std::uint32_t counter, const KeyframeSlot& slot) {
      const auto* culled = std::get_if<CulledKeyframe>(&slot);
      if (culled != nullptr || std::holds_alternative<Gone>(slot)) visit({part.session, counter}, culled);
    });
  }
}

void Atlas::ForEachFormerLandmark(const std::function<void(LandmarkId, LandmarkId)>& visit) const {
  for (const Part& part : parts_) {
    part.landmarks.ForEach([&](std::uint32_t counter, const LandmarkSlot& slot) {
      const auto* absorber = std::get_if<LandmarkId>(&slot);
      const bool gone = std::holds_alternative<Gone>(slot);
      if (absorber != nullptr || gone) visit({part.session, counter}, gone ? LandmarkId{} : *absorber);
    });
  }
}

const std::map<MapId, MapId>& Atlas::merged_maps() const {
  static const std::map<MapId, MapId> kNone;
  return maps_.get() == nullptr ? kNone : maps_.get()->merged;
}

std::size_t Atlas::keyframe_count(SessionId session) const {
  const Part* part = FindPart(session);
  return part == nullptr ? 0 : part->keyframe_count;
}

std::size_t Atlas::landmark_count(SessionId session) const {
  const Part* part = FindPart(session);
  return part == nullptr ? 0 : part->landmark_count;
}

const std::vector<LoopEdge>& Atlas::loop_edges() const {
  static const std::vector<LoopEdge> kNone;
  return loop_edges_.get() == nullptr ? kNone : *loop_edges_.get();
}

}  // namespace pangaea
