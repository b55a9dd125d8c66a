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
  // The window of the search is what poses may be off far from any seam; descriptors may differ a little more than in
  // local mapping, for views are farther apart, and geometry decides.
  LandmarkSearchOptions search = {.radius = 4.0, .old_radius = 4.0, .fusion_gate = 4.0, .one_per_keypoint = false};
  // Edge of the cubes by which landmarks are found, in median depths of the map.
  double cube_edge = 0.15;

  // Says which option is out of which range.
  Status Check() const;
};

// As a WeldingPlan's: first the edits (ApplyTolerantly), then the correction (Rebase).
struct MapFusion {
  std::vector<MapEdit> edits;
  Correction correction;  // against the snapshot
  Atlas after;            // the snapshot with both
  std::size_t fused = 0;
  std::size_t added = 0;
};

// Looks all along a map for landmarks that exist twice, because the map was merged or a loop closed elsewhere (a
// welding window covers only the seam), or because a session did not recognise what it had left for a while: in each of
// the given keyframes, whatever lies in its view is looked for. Expects poses that are right to the search window:
// after the pose graph, better after a bundle adjustment (and makes the next one tighter). Ids that are not in the map
// are left out. A stop ends it early: what was found so far is good.
MapFusion FuseDuplicates(const Atlas& snapshot, MapId map, const std::vector<KeyframeId>& keyframes,
                         const MapFusionOptions& options, std::stop_token stop);

}  // namespace pangaea
