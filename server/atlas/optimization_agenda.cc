#include "server/atlas/optimization_agenda.h"

#include <algorithm>

namespace pangaea {

bool IsWelded(const Atlas& atlas, MapId map) {
  return std::ranges::any_of(atlas.loop_edges(), [&](const LoopEdge& edge) {
    const Keyframe* keyframe = atlas.FindKeyframe(edge.from);
    return keyframe != nullptr && keyframe->map == map;
  });
}
Status OptimizationAgendaOptions::Check() const {
  if (growth > 0.0 && patience >= 1 && settled_share >= 0.0 && closing_rounds >= 0) return {};
  return Fail(ErrorCode::kInvalidArgument,
              "growth must be above 0, patience at least 1, settled_share and closing_rounds at least 0");
}

void OptimizationAgenda::MakeDue(MapId map) { due_.emplace(map, ++clock_); }

bool OptimizationAgenda::MapWelded(MapId map) {
  MakeDue(map);
  if (running_ != map) return false;
  cancelled_ = true;
  return true;
}

void OptimizationAgenda::SessionClosedMap(const Atlas& atlas, SessionId session) {
  std::set<MapId> maps;
  atlas.ForEachKeyframe(session, [&](const Keyframe& keyframe) { maps.insert(keyframe.map); });
  for (const MapId map : maps) {
    const Optimized& last = running_ == map ? at_start_ : optimized_[map];
    closing_[map] = options_.closing_rounds;
    const bool is_new = atlas.FindMap(map)->keyframes != last.keyframes || !last.settled;
    if (is_new && IsWelded(atlas, map)) MakeDue(map);
  }
}

void OptimizationAgenda::Update(const Atlas& atlas) {
  std::map<MapId, std::size_t> due;
  for (const auto& [map, time] : due_) {
    const MapId now = atlas.Resolve(map);
    if (!now.valid()) continue;
    const auto [entry, fresh] = due.emplace(now, time);
    if (!fresh) entry->second = std::min(entry->second, time);
  }
  due_ = std::move(due);
  const auto is_gone = [&](const auto& entry) { return atlas.FindMap(entry.first) == nullptr; };
  std::erase_if(optimized_, is_gone);
  std::erase_if(closing_, is_gone);
  for (const MapId id : atlas.Maps()) {
    const MapInfo& map = *atlas.FindMap(id);
    const Optimized& last = running_ == id ? at_start_ : optimized_[id];
    const auto grown = static_cast<double>(last.keyframes) * (1.0 + options_.growth);
    const bool finished = map.closed && !last.closed && map.keyframes > 1;
    if (finished || (static_cast<double>(map.keyframes) > grown && IsWelded(atlas, id))) MakeDue(id);
  }
}

std::optional<MapId> OptimizationAgenda::Start(const Atlas& atlas) {
  if (running_ || due_.empty()) return std::nullopt;
  const auto next = std::ranges::min_element(due_, {}, [](const auto& entry) { return entry.second; });
  const MapId map = next->first;
  due_.erase(next);
  const MapInfo* info = atlas.FindMap(map);
  if (info == nullptr) return std::nullopt;
  running_ = map;
  cancelled_ = false;
  at_start_ = {info->keyframes, info->landmarks, info->closed, true};
  return map;
}

void OptimizationAgenda::Finish(bool done, std::size_t fused) {
  const MapId map = *running_;
  running_.reset();
  if (cancelled_ && !done) {
    ++cancellations_[map];
    MakeDue(map);
    return;
  }
  // One that failed is not tried again before the map changes.
  cancellations_.erase(map);
  const auto settled = options_.settled_share * static_cast<double>(at_start_.landmarks);
  at_start_.settled = static_cast<double>(fused) <= settled;
  optimized_[map] = at_start_;
  const auto closing = closing_.find(map);
  if (closing == closing_.end()) return;
  if (at_start_.settled || closing->second == 0) {
    closing_.erase(closing);
  } else {
    --closing->second;
    MakeDue(map);
  }
}

bool OptimizationAgenda::HoldsLoops(MapId map) const {
  const auto found = cancellations_.find(map);
  return found != cancellations_.end() && found->second >= options_.patience && (running_ == map || due_.contains(map));
}

}  // namespace pangaea
