#pragma once

#include <functional>
#include <optional>
#include <stop_token>

#include "common/map/atlas.h"
#include "server/atlas/welding_edits.h"
#include "server/fusion/map_fusion.h"
#include "server/optimization/global_bundle_adjustment.h"

namespace pangaea {

struct MapOptimizationOptions {
  MapFusionOptions fusion{};
  GlobalBundleOptions bundle{};

  Status Check() const;
};

struct MapOptimization {
  OptimizedMap optimized;
  std::size_t fused = 0;  // duplicates all along the map
  std::size_t looks = 0;  // as MapFusion's
  GlobalBundle bundle;    // its correction and removals are part of `optimized`
};

// Looks for duplicates all along a map, as far as it has changed since the looks that `before` tells of, and then
// adjusts it as a whole. Nothing where a stop was requested, or where there is too little to adjust. `out_of_time`: see
// AdjustMap.
std::optional<MapOptimization> OptimizeMap(const Atlas& snapshot, MapId map, const MapOptimizationOptions& options,
                                           const LookedAtMap& before, const std::stop_token& stop,
                                           const std::function<bool()>& out_of_time = {});

}  // namespace pangaea
