#pragma once

#include <cstddef>
#include <vector>

#include "agent/mapping/local_mapping_options.h"
#include "common/map/atlas.h"

namespace pangaea {

// At most `count` covisible keyframes, the one that shares most landmarks first, of equals the newer.
std::vector<KeyframeId> BestCovisible(const Keyframe& keyframe, std::size_t count);

// The keyframes around `center` whose landmarks it may see and the other way round, without itself: its best covisible
// ones and its parent, the best ones of those, and keyframes that merely look at the same place. The last matters
// when a place is seen again: nothing is shared with the old keyframes yet.
std::vector<KeyframeId> Neighbourhood(const Atlas& atlas, const Keyframe& center, const NeighbourhoodOptions& options);

}  // namespace pangaea
