#include "server/atlas/map_optimization.h"

#include <utility>

namespace pangaea {

Status MapOptimizationOptions::Check() const {
  if (auto status = fusion.Check(); !status) return status;
  return bundle.Check();
}

std::optional<MapOptimization> OptimizeMap(const Atlas& snapshot, MapId map, const MapOptimizationOptions& options,
                                           const LookedAtMap& before, const std::stop_token& stop,
                                           const std::function<bool()>& out_of_time) {
  MapFusion fusion = FuseDuplicates(snapshot, map, options.fusion, before, stop);
  auto bundle = AdjustMap(fusion.after, map, options.bundle, stop, out_of_time);
  if (!bundle) return std::nullopt;
  MapOptimization result;
  result.fused = fusion.fused;
  result.looks = fusion.looks;
  result.optimized.joins = std::move(fusion.edits);
  result.optimized.corrections.push_back(std::move(fusion.correction));
  result.optimized.corrections.push_back(std::move(bundle->correction));
  result.optimized.looked_at = std::move(fusion.looked_at);
  result.optimized.removals = std::move(bundle->removals);
  result.bundle = std::move(*bundle);
  return result;
}

}  // namespace pangaea
