#pragma once

#include <cstddef>
#include <stop_token>
#include <vector>

#include "common/map/atlas.h"
#include "common/map/edits/edits.h"
#include "common/mapping/landmark_search.h"
#include "server/optimization/correction.h"

namespace pangaea {

struct MapFusionOptions {
  LandmarkSearchOptions search = {.radius = 4.0, .old_radius = 4.0, .fusion_gate = 4.0};
  // In a keyframe, the landmarks of so many others are looked for: those that look at the same place and share least of
  // it with the keyframe (count).
  std::size_t others = 10;
  // Of what another keyframe sees, this part must be in view and be no common landmark yet.
  double min_unshared = 0.15;
  std::size_t samples = 40;      // landmarks tried for that (count)
  double max_axis_angle = 50.0;  // degrees between the optical axes of the two

  // Says which option is out of which range.
  Status Check() const;
};

// As a WeldingPlan's: first the edits (ApplyTolerantly), then the correction (Rebase).
struct MapFusion {
  std::vector<MapEdit> edits;
  Correction correction;
  std::size_t fused = 0;
  std::size_t added = 0;
};

// Looks all along a map, in the given keyframes, for landmarks that exist twice because the map was merged or a loop
// closed elsewhere: a welding window covers only the seam. Expects poses that are right to the search window: after the
// pose graph, better after a bundle adjustment (and makes the next one tighter). Ids that are not in the map are left
// out. A stop ends it early: what was found so far is good.
MapFusion FuseDuplicates(const Atlas& snapshot, MapId map, const std::vector<KeyframeId>& keyframes,
                         const MapFusionOptions& options, std::stop_token stop);

}  // namespace pangaea
