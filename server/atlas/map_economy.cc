#include "server/atlas/map_economy.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "common/base/range_check.h"
#include "common/map/covisibility.h"
#include "common/map/map_edit.h"

namespace pangaea {
namespace {

void ApplyAll(const std::vector<MapEdit>& edits, Atlas& atlas) { (void)ApplyTolerantly(edits, atlas); }

void Append(std::vector<MapEdit> edits, std::vector<MapEdit>& all) {
  std::ranges::move(edits, std::back_inserter(all));
}

}  // namespace

Status InUseOptions::Check() const {
  RangeCheck check("in use");
  check.In("newest", newest, 1, 1e6).In("around", around, 0, 1e6);
  return check.status();
}

Status EconomyOptions::Check() const {
  if (auto status = fusion.Check(); !status) return status;
  return thinning.Check();
}

std::set<KeyframeId> KeyframesInUse(const IngestState& state, const InUseOptions& options) {
  std::set<KeyframeId> in_use;
  for (const auto& [session, record] : state.sessions) {
    if (!record.alive()) continue;
    std::vector<KeyframeId> own;
    state.atlas.ForEachKeyframe(session, [&own](const Keyframe& keyframe) { own.push_back(keyframe.id); });
    if (own.empty()) continue;
    in_use.insert(own.end() - static_cast<std::ptrdiff_t>(std::min(options.newest, own.size())), own.end());
    const std::vector<KeyframeId> around = GrowWindow(state.atlas, own.back(), options.around);
    in_use.insert(around.begin(), around.end());
  }
  return in_use;
}

std::optional<MapEconomy> EconomizeMap(const Atlas& snapshot, MapId map, const std::set<KeyframeId>& in_use,
                                       const EconomyOptions& options, const RedundancyOptions& redundancy,
                                       const LookedAtMap& before, const std::stop_token& stop) {
  MapFusion fusion = FuseDuplicates(snapshot, map, options.fusion, before, stop);
  Atlas draft = std::move(fusion.after);
  // These go through the whole map each time: what is weakest or most redundant is so compared with all others. That
  // takes a small part of what a look for duplicates at everything takes.
  std::vector<MapEdit> landmarks = PlanThinning(draft, map, in_use, options.thinning, stop);
  ApplyAll(landmarks, draft);
  std::vector<MapEdit> keyframes = PlanKeyframeCulling(draft, map, in_use, redundancy, stop);
  ApplyAll(keyframes, draft);
  if (stop.stop_requested() || draft.FindMap(map) == nullptr) return std::nullopt;
  MapEconomy economy{.map = map,
                     .changes = {},
                     .fused = fusion.fused,
                     .landmarks = landmarks.size(),
                     .keyframes = keyframes.size(),
                     .after = std::move(draft)};
  economy.changes.joins = std::move(fusion.edits);
  economy.changes.corrections.push_back(std::move(fusion.correction));
  economy.changes.looked_at = std::move(fusion.looked_at);
  Append(std::move(landmarks), economy.changes.removals);
  Append(std::move(keyframes), economy.changes.removals);
  return economy;
}

std::string Describe(const MapEconomy& economy) {
  const MapInfo& after = *economy.after.FindMap(economy.map);
  return "map " + ToString(economy.map) + ": " + std::to_string(economy.fused) + " duplicates fused, " +
         std::to_string(economy.landmarks) + " weak landmarks and " + std::to_string(economy.keyframes) +
         " redundant keyframes removed; " + std::to_string(after.landmarks) + " landmarks and " +
         std::to_string(after.keyframes) + " keyframes remain";
}

}  // namespace pangaea
