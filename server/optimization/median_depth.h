#pragma once

#include "common/map/atlas.h"

namespace pangaea {

// The median distance, along the optical axis, of a map's landmarks from their reference keyframes: its typical length,
// in map units. 1 where the map has no landmarks.
double MedianDepth(const Atlas& atlas, MapId map);

}  // namespace pangaea
