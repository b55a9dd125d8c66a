#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/map/atlas.h"
#include "common/map/id_set.h"

namespace pangaea {

// The keyframes that share at least `min_weight` landmarks with this one, by weight descending, then by id. Empty for
// an unknown id.
std::vector<Covisibility> CovisibleKeyframes(const Atlas& atlas, KeyframeId id, std::uint32_t min_weight = 1);

// The seed, then its covisible keyframes by weight, then theirs in the same order, and so on until there are
// `max_keyframes`. Empty for an unknown seed.
std::vector<KeyframeId> GrowWindow(const Atlas& atlas, KeyframeId seed, std::size_t max_keyframes);

// The landmarks that the keyframes observe. Unknown ids are left out.
LandmarkIdSet LandmarkSetOf(const Atlas& atlas, const std::vector<KeyframeId>& keyframes);
// The same, ascending, each once.
std::vector<LandmarkId> LandmarksSeenBy(const Atlas& atlas, const std::vector<KeyframeId>& keyframes);

}  // namespace pangaea
