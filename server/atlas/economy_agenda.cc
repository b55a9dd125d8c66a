#include "server/atlas/economy_agenda.h"

#include "server/atlas/optimization_agenda.h"

namespace pangaea {
namespace {

struct Occupation {
  std::size_t idle = 0;
  std::size_t in_use = 0;
};

std::map<MapId, Occupation> Occupations(const Atlas& atlas, const std::set<KeyframeId>& in_use) {
  std::map<MapId, Occupation> occupations;
  atlas.ForEachKeyframe([&](const Keyframe& keyframe) {
    Occupation& occupation = occupations[keyframe.map];
    ++(in_use.contains(keyframe.id) ? occupation.in_use : occupation.idle);
  });
  return occupations;
}

}  // namespace

void EconomyAgenda::Recover(const Atlas& atlas) {
  for (const auto& [map, occupation] : Occupations(atlas, {})) {
    if (IsWelded(atlas, map)) idle_[map] = occupation.idle;
  }
}

std::optional<MapId> EconomyAgenda::Next(const Atlas& atlas, const std::set<KeyframeId>& in_use,
                                         std::optional<MapId> only) {
  std::erase_if(idle_, [&](const auto& entry) { return atlas.FindMap(entry.first) == nullptr; });
  for (const auto& [map, occupation] : Occupations(atlas, in_use)) {
    if (only && map != *only) continue;
    const std::size_t last = idle_[map];
    const bool grown = static_cast<double>(occupation.idle) > static_cast<double>(last) * (1.0 + growth_);
    const bool left = occupation.in_use == 0 && occupation.idle > last;
    if ((grown || left) && IsWelded(atlas, map)) return map;
  }
  return std::nullopt;
}

bool EconomyAgenda::MapWelded(MapId map) {
  if (running_ != map || cancellations_ >= patience_) return false;
  ++cancellations_;
  return true;
}

void EconomyAgenda::Finish(const Atlas& atlas, const std::set<KeyframeId>& in_use) {
  idle_[*running_] = Occupations(atlas, in_use)[*running_].idle;
  running_.reset();
  cancellations_ = 0;
}

}  // namespace pangaea
