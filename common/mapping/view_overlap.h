#pragma once

#include <cstddef>

#include "common/map/atlas.h"
#include "common/mapping/view_prediction.h"

namespace pangaea {

// The part of a keyframe's landmarks (of so many of them, evenly chosen) that lie in front of the viewpoint and inside
// its image; 0 where it has none.
double VisibleShare(const Atlas& atlas, const Keyframe& keyframe, const Viewpoint& viewpoint, std::size_t samples);

}  // namespace pangaea
