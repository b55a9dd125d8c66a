#include "server/atlas/comparison_agenda.h"

#include <algorithm>

#include "common/base/range_check.h"
#include "common/map/metric_map.h"

namespace pangaea {
namespace {

// By the agent of all of it: where others were merged into it, that was said of a part.
bool IsClosed(const Atlas& atlas, MapId map) {
  if (!atlas.FindMap(map)->closed) return false;
  return std::ranges::none_of(atlas.merged_maps(),
                              [&](const auto& merged) { return atlas.Resolve(merged.first) == map; });
}

}  // namespace

Status ComparisonAgendaOptions::Check() const {
  return RangeCheck("map comparison").In("min_keyframes", min_keyframes, 1, RangeCheck::kUnlimited).status();
}

std::set<MapId> MapsInWork(const IngestState& state) {
  std::set<MapId> maps;
  for (const auto& [id, session] : state.sessions) {
    if (!session.alive()) continue;
    state.atlas.ForEachKeyframe(id, [&](const Keyframe& keyframe) { maps.insert(keyframe.map); });
  }
  return maps;
}

bool ComparisonAgenda::IsComparable(const Atlas& atlas, MapId map) const {
  return atlas.FindMap(map)->keyframes >= options_.min_keyframes && IsMetric(atlas, map);
}

void ComparisonAgenda::Recover(const Atlas& atlas) {
  for (const MapId id : atlas.Maps()) {
    if (IsComparable(atlas, id) && IsClosed(atlas, id)) compared_[id] = atlas.FindMap(id)->keyframes;
  }
}

void ComparisonAgenda::Update(const Atlas& atlas, const std::function<bool(MapId)>& is_left) {
  // Culled keyframes are no growth when others come instead.
  for (auto& [id, keyframes] : compared_) {
    const MapInfo* map = atlas.FindMap(id);
    keyframes = map == nullptr ? 0 : std::min<std::size_t>(keyframes, map->keyframes);
  }
  std::erase_if(compared_, [](const auto& entry) { return entry.second == 0; });
  over_.clear();
  for (const MapId id : atlas.Maps()) {
    if (IsComparable(atlas, id) && (IsClosed(atlas, id) || is_left(id))) over_.insert(id);
  }
  for (const MapId id : over_) {
    const std::size_t keyframes = atlas.FindMap(id)->keyframes;
    const auto [before, is_new] = compared_.try_emplace(id, keyframes);
    if (!is_new && keyframes <= before->second) continue;
    before->second = keyframes;
    for (const MapId other : over_) {
      if (other != id && !Waits(id, other)) waiting_.emplace_back(id, other);
    }
  }
}

bool ComparisonAgenda::Waits(MapId a, MapId b) const {
  return std::ranges::any_of(waiting_, [&](const std::pair<MapId, MapId>& pair) {
    return pair == std::pair(a, b) || pair == std::pair(b, a);
  });
}

std::optional<std::pair<MapId, MapId>> ComparisonAgenda::Next(const Atlas& atlas) {
  while (!waiting_.empty()) {
    const auto pair = waiting_.front();
    waiting_.pop_front();
    const auto is_over = [&](MapId map) { return over_.contains(map) && atlas.FindMap(map) != nullptr; };
    if (is_over(pair.first) && is_over(pair.second)) return pair;
  }
  return std::nullopt;
}

}  // namespace pangaea
