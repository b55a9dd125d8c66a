#pragma once

#include "common/map/atlas.h"

namespace pangaea {

// Whether lengths in the map are metres: it began with a stereo camera. (A merge never lets a scale-free map survive a
// metric one, so the root tells.) False for a map that is not alive.
bool IsMetric(const Atlas& atlas, MapId map);

}  // namespace pangaea
