#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <stop_token>
#include <string>

#include "common/base/result.h"
#include "common/map/atlas.h"
#include "server/atlas/welding_edits.h"
#include "server/fusion/landmark_thinning.h"
#include "server/fusion/map_fusion.h"
#include "server/fusion/redundancy.h"
#include "server/ingest/ingest_round.h"

namespace pangaea {

// What of the atlas living agents work on: it is left as it is.
struct InUseOptions {
  std::size_t newest = 500;  // keyframes of a living session
  std::size_t around = 40;   // and those around the newest one, by what they see in common

  Status Check() const;
};

std::set<KeyframeId> KeyframesInUse(const IngestState& state, const InUseOptions& options);

struct EconomyOptions {
  // Without it, keyframes and landmarks go under a memory budget alone.
  bool enabled = true;
  // Poses are adjusted by then: a narrow window, in which descriptors of views from afar may differ more.
  MapFusionOptions fusion{.search = {.radius = 2.5,
                                     .old_radius = 2.5,
                                     .fusion_gate = 2.5,
                                     .max_distance = 75,
                                     .max_ratio = 0.9,
                                     .one_per_keypoint = false}};
  ThinningOptions thinning{};

  Status Check() const;
};

// What a map needs no longer, against the snapshot.
struct MapEconomy {
  MapId map;
  OptimizedMap changes;       // duplicates fused, then what goes
  std::size_t fused = 0;      // duplicates that became one
  std::size_t landmarks = 0;  // weak ones that go
  std::size_t keyframes = 0;  // redundant ones that go
  Atlas after;                // the snapshot with all that

  bool empty() const { return fused + landmarks + keyframes == 0; }
};

// Makes one landmark of those that are one, removes weak landmarks where there are enough others, then the keyframes
// that say nothing new. Duplicates are looked for where the map has changed since the looks that `before` tells of. For
// a map that was adjusted as a whole; it wants to be adjusted once more afterwards. A stop gives nothing.
std::optional<MapEconomy> EconomizeMap(const Atlas& snapshot, MapId map, const std::set<KeyframeId>& in_use,
                                       const EconomyOptions& options, const RedundancyOptions& redundancy,
                                       const LookedAtMap& before, const std::stop_token& stop);

// One line for people.
std::string Describe(const MapEconomy& economy);

}  // namespace pangaea
