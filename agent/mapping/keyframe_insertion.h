#pragma once

#include <vector>

#include "agent/mapping/keyframe_candidate.h"
#include "agent/mapping/local_mapping_options.h"
#include "common/map/atlas.h"
#include "common/map/edits/edits.h"

namespace pangaea {

// The candidate enters the map with the landmarks that were tracked. Its parent in the spanning tree is the keyframe
// that shares most of them, its reference where none does; a candidate without a reference is the root of a new map.
// Its pose is refined on those landmarks as they are now.
// No edits when the candidate cannot enter: its id or (for a root) its map exists already, its reference is unknown or
// of another map, its map is closed.
std::vector<MapEdit> InsertKeyframe(const Atlas& atlas, const KeyframeCandidate& candidate,
                                    const MeasurementNoiseOptions& noise);

}  // namespace pangaea
