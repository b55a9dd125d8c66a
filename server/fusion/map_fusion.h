#pragma once

#include <cstddef>
#include <optional>
#include <stop_token>
#include <vector>

#include "common/map/atlas.h"
#include "common/map/edits/edits.h"
#include "common/mapping/landmark_search.h"
#include "server/fusion/look_memory.h"
#include "server/optimization/correction.h"

namespace pangaea {

struct MapFusionOptions {
  // The search's radii and gate at most. The window is what poses may be off far from any seam; descriptors may differ
  // a little more than in local mapping, for views are farther apart, and geometry decides.
  LandmarkSearchOptions search = {.radius = 4.0, .old_radius = 4.0, .fusion_gate = 4.0, .one_per_keypoint = false};
  // As far as so many standard deviations of the noise that the map shows, the window and the gate reach, but not less
  // than `least_radius` (octave pixels): two corners a pixel or two apart look much alike, and made one they bend the
  // map (docs/decisions/0025-noise-of-a-map.md).
  double noise_radius = 3.7;
  double least_radius = 1.0;
  // What was looked for in a keyframe in vain is looked for again when it has moved in its image by this share of the
  // search radius since: then the window is clearly another one.
  double tolerance = 0.5;
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
  // `before` of the next look, once this one was taken. Nothing where a stop ended it.
  std::optional<LookedAtMap> looked_at;
  std::size_t fused = 0;
  std::size_t added = 0;
  std::size_t looks = 0;  // for one landmark in one keyframe each
};

// Looks all along a map for landmarks that exist twice, because the map was merged or a loop closed elsewhere (a
// welding window covers only the seam), or because a session did not recognise what it had left for a while: in each
// keyframe whatever lies in its view is looked for, but only where something has changed since the looks that `before`
// tells of (PlanLook; empty: everything), so that its cost follows what changed. Looks with different options know
// nothing of each other. Expects poses that are right to the search window: after the pose graph, better after a bundle
// adjustment (and makes the next one tighter). A stop ends it early: what was found so far is good.
MapFusion FuseDuplicates(const Atlas& snapshot, MapId map, const MapFusionOptions& options, const LookedAtMap& before,
                         const std::stop_token& stop);

}  // namespace pangaea
