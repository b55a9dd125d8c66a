#include "server/fusion/map_fusion.h"

#include <algorithm>
#include <utility>

#include "common/base/range_check.h"
#include "common/estimation/measured_noise.h"
#include "common/map/id_set.h"
#include "common/map/spanning_tree.h"
#include "common/mapping/bundle_window.h"
#include "server/fusion/duplicate_fusion.h"
#include "server/fusion/landmark_index.h"
#include "server/fusion/look_plan.h"
#include "server/fusion/welding_draft.h"
#include "server/optimization/global_bundle_adjustment.h"
#include "server/optimization/median_depth.h"

namespace pangaea {
namespace {

class MapLook {
 public:
  MapLook(const Atlas& snapshot, MapId map, const LandmarkSearchOptions& search)
      : map_(map), draft_(snapshot), fusion_({}, search, draft_) {}

  void SearchIn(KeyframeId id, const LandmarkIndex& landmarks) {
    const std::vector<LandmarkId> wanted = landmarks.InView(Viewpoint(*draft_.welded().FindKeyframe(id)));
    if (wanted.empty()) return;
    looks_ += wanted.size();
    fusion_.SearchIn(id, wanted);
  }

  MapFusion Finish() && {
    MapFusion result{.edits = draft_.edits(),
                     .correction = draft_.Moves(map_),
                     .after = draft_.welded(),
                     .looked_at = {},
                     .looks = looks_};
    for (const MapEdit& edit : result.edits) {
      result.fused += std::holds_alternative<FuseLandmarks>(edit) ? 1 : 0;
      result.added += std::holds_alternative<AddObservation>(edit) ? 1 : 0;
    }
    return result;
  }

 private:
  MapId map_;
  WeldingDraft draft_;
  DuplicateFusion fusion_;
  std::size_t looks_ = 0;
};

std::vector<PlacedLandmark> Places(const LookedAtMap& map) {
  std::vector<PlacedLandmark> places;
  places.reserve(map.landmarks.size());
  for (const auto& landmark : map.landmarks) places.push_back({landmark.id, landmark.point_in_map});
  return places;
}

// One whose fusion did not fit the atlas as it was by then is looked for again.
void ForgetAbsorbed(const std::vector<MapEdit>& edits, LookedAtMap& map) {
  LandmarkIdSet absorbed;
  for (const MapEdit& edit : edits) {
    if (const auto* fusion = std::get_if<FuseLandmarks>(&edit)) absorbed.Insert(fusion->absorbed);
  }
  std::erase_if(map.landmarks, [&](const auto& landmark) { return absorbed.Contains(landmark.id); });
}

// Made narrower to what the map's noise allows.
LandmarkSearchOptions SearchIn(const Atlas& snapshot, MapId map, const MapFusionOptions& options) {
  const WindowBundle bundle = BuildWindowBundle(snapshot, WholeMap(snapshot, map), {});
  const double reach = std::max(options.least_radius, options.noise_radius * MeasuredNoise(bundle.problem));
  LandmarkSearchOptions search = options.search;
  for (double* radius : {&search.radius, &search.old_radius, &search.fusion_gate}) *radius = std::min(*radius, reach);
  return search;
}

}  // namespace

Status MapFusionOptions::Check() const {
  RangeCheck check("map fusion");
  check.In("search.radius", search.radius, 0.5, 100)
      .In("search.fusion_gate", search.fusion_gate, 0.5, 100)
      .In("search.max_distance", search.max_distance, 0, 256)
      .In("search.max_ratio", search.max_ratio, 0, 1)
      .In("noise_radius", noise_radius, 1, 1000)
      .In("least_radius", least_radius, 0.1, 100)
      .In("tolerance", tolerance, 0, 10)
      .In("cube_edge", cube_edge, 0.001, 1000);
  return check.status();
}

MapFusion FuseDuplicates(const Atlas& snapshot, MapId map, const MapFusionOptions& options, const LookedAtMap& before,
                         const std::stop_token& stop) {
  const double edge = options.cube_edge * MedianDepth(snapshot, map);
  LookedAtMap now = LookedAtMap::Of(snapshot, map);
  const LandmarkIndex index(Places(now), edge);
  const LandmarkSearchOptions search = SearchIn(snapshot, map, options);
  const double tolerance = options.tolerance * search.radius;
  LookPlan plan = PlanLook(snapshot, std::move(now), before, index, tolerance, stop);
  const LandmarkIndex changed(plan.landmarks, edge);
  MapLook look(snapshot, map, search);
  for (const KeyframeId id : ParentsFirst(snapshot, map)) {
    if (stop.stop_requested()) return std::move(look).Finish();
    look.SearchIn(id, plan.keyframes.contains(id) ? index : changed);
  }
  MapFusion fusion = std::move(look).Finish();
  ForgetAbsorbed(fusion.edits, plan.after);
  fusion.looked_at = std::move(plan.after);
  return fusion;
}

}  // namespace pangaea
