#include "server/atlas/comparison_agenda.h"

#include <algorithm>

#include "common/base/range_check.h"
#include "common/map/metric_map.h"

namespace pangaea {

Status ComparisonAgendaOptions::Check() const {
  return RangeCheck("map comparison")
      .In("min_keyframes", min_keyframes, 1, RangeCheck::kUnlimited)
      .status();
}

bool ComparisonAgenda::IsComparable(const Atlas& atlas, MapId map) const {
  return atlas.FindMap(map)->keyframes >= options_.min_keyframes && IsMetric(atlas, map);
}

void ComparisonAgenda::Recover(const Atlas& atlas) {
  for (const MapId id : atlas.Maps()) {
    if (IsComparable(atlas, id)) compared_[id] = atlas.FindMap(id)->keyframes;
  }
}

void ComparisonAgenda::Update(const Atlas& atlas, const std::function<bool(MapId)>& is_left) {
  std::erase_if(compared_, [&](const auto& entry) { return atlas.FindMap(entry.first) == nullptr; });
  const std::vector<MapId> maps = atlas.Maps();
  for (const MapId id : maps) {
    const MapInfo& map = *atlas.FindMap(id);
    const bool is_over = map.closed || is_left(id);
    if (!is_over || !IsComparable(atlas, id)) continue;
    const auto [before, is_new] = compared_.try_emplace(id, map.keyframes);
    if (!is_new && map.keyframes <= before->second) continue;
    before->second = map.keyframes;
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
