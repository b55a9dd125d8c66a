#include "server/atlas/comparison_agenda.h"

#include <algorithm>

#include "common/base/range_check.h"
#include "common/map/metric_map.h"

namespace pangaea {

Status ComparisonAgendaOptions::Check() const {
  return RangeCheck("map comparison")
      .In("min_keyframes", min_keyframes, 1, RangeCheck::kUnlimited)
      .In("growth", growth, 1.01, 1000.0)
      .status();
}

bool ComparisonAgenda::IsComparable(const Atlas& atlas, MapId map) const {
  return atlas.FindMap(map)->keyframes >= options_.min_keyframes && IsMetric(atlas, map);
}

bool ComparisonAgenda::IsDue(const MapInfo& map) const {
  const auto before = compared_.find(map.id);
  if (before == compared_.end()) return true;
  const auto [keyframes, was_closed] = before->second;
  if (static_cast<double>(map.keyframes) >= options_.growth * static_cast<double>(keyframes)) return true;
  return map.closed && !was_closed && map.keyframes > keyframes;
}

void ComparisonAgenda::Recover(const Atlas& atlas) {
  for (const MapId id : atlas.Maps()) {
    const MapInfo& map = *atlas.FindMap(id);
    if (IsComparable(atlas, id)) compared_[id] = {map.keyframes, map.closed};
  }
}

void ComparisonAgenda::Update(const Atlas& atlas) {
  std::erase_if(compared_, [&](const auto& entry) { return atlas.FindMap(entry.first) == nullptr; });
  const std::vector<MapId> maps = atlas.Maps();
  for (const MapId id : maps) {
    const MapInfo& map = *atlas.FindMap(id);
    if (!IsComparable(atlas, id) || !IsDue(map)) continue;
    compared_[id] = {map.keyframes, map.closed};
    for (const MapId other : maps) {
      if (other == id || !IsComparable(atlas, other)) continue;
      const auto waits = [&](const std::pair<MapId, MapId>& pair) {
        return pair == std::pair(id, other) || pair == std::pair(other, id);
      };
      if (std::ranges::none_of(waiting_, waits)) waiting_.emplace_back(id, other);
    }
  }
}

std::optional<std::pair<MapId, MapId>> ComparisonAgenda::Next(const Atlas& atlas) {
  while (!waiting_.empty()) {
    const auto pair = waiting_.front();
    waiting_.pop_front();
    if (atlas.FindMap(pair.first) != nullptr && atlas.FindMap(pair.second) != nullptr) return pair;
  }
  return std::nullopt;
}

}  // namespace pangaea
