#pragma once

#include <stop_token>
#include <unordered_set>
#include <vector>

#include "common/map/atlas.h"
#include "server/fusion/landmark_index.h"
#include "server/fusion/look_memory.h"

namespace pangaea {

// Where duplicates may be that an earlier look did not find: everything in the view of some keyframes, and some
// landmarks in the view of every keyframe.
struct LookPlan {
  std::unordered_set<KeyframeId> keyframes;
  std::vector<PlacedLandmark> landmarks;
  LookedAtMap after;  // what to remember once it was looked there
};

// What has changed in a map since `before` so much that a search might find what it did not find then:
// - keyframes that are new, or in whose image most of what is in view has moved by more than half of `tolerance`
//   (pixels);
// - landmarks that are new, that clearly more or fewer keyframes see, that have moved by as much apart from what is
//   around them, or that a keyframe sees which has moved.
// Motions add up from look to look: what is not looked for in a keyframe has moved in its image by no more than
// `tolerance` since it was. What moves together has not moved.
// Left alone is what could take the place of a landmark that a keypoint has lost: an observation more, no duplicate.
// `index` of all landmarks of `now`, which is the map in `atlas`. A stop gives half a plan, not to be followed.
LookPlan PlanLook(const Atlas& atlas, LookedAtMap now, const LookedAtMap& before, const LandmarkIndex& index,
                  double tolerance, const std::stop_token& stop);

}  // namespace pangaea
