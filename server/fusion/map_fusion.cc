#include "server/fusion/map_fusion.h"

#include "common/base/range_check.h"
#include "server/fusion/duplicate_fusion.h"
#include "server/fusion/landmark_index.h"
#include "server/fusion/welding_draft.h"
#include "server/optimization/median_depth.h"

namespace pangaea {

Status MapFusionOptions::Check() const {
  RangeCheck check("map fusion");
  check.In("search.radius", search.radius, 0.5, 100)
      .In("search.fusion_gate", search.fusion_gate, 0.5, 100)
      .In("search.max_distance", search.max_distance, 0, 256)
      .In("search.max_ratio", search.max_ratio, 0, 1)
      .In("cube_edge", cube_edge, 0.001, 1000);
  return check.status();
}

MapFusion FuseDuplicates(const Atlas& snapshot, MapId map, const std::vector<KeyframeId>& keyframes,
                         const MapFusionOptions& options, std::stop_token stop) {
  WeldingDraft draft(snapshot);
  DuplicateFusion fusion({}, options.search, draft);
  const LandmarkIndex index(snapshot, map, options.cube_edge * MedianDepth(snapshot, map));
  for (const KeyframeId id : keyframes) {
    if (stop.stop_requested()) break;
    const Keyframe* keyframe = draft.welded().FindKeyframe(id);
    if (keyframe == nullptr || keyframe->map != map) continue;
    fusion.SearchIn(id, index.InView(Viewpoint(*keyframe)));
  }
  MapFusion result{.edits = draft.edits(), .correction = draft.Moves(map), .after = draft.welded()};
  for (const MapEdit& edit : result.edits) {
    result.fused += std::holds_alternative<FuseLandmarks>(edit) ? 1 : 0;
    result.added += std::holds_alternative<AddObservation>(edit) ? 1 : 0;
  }
  return result;
}

}  // namespace pangaea
