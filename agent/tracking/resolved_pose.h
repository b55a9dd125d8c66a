#pragma once

#include <optional>

#include "common/map/atlas.h"

namespace pangaea {

// camera_from_map of a keyframe, also of one that was culled; nothing for one that the atlas does not know.
std::optional<Rigid3d> PoseOf(const Atlas& atlas, KeyframeId id);

// Whether the keyframe, or what a culled one forwards to, is in the map.
bool IsInMap(const Atlas& atlas, KeyframeId id, MapId map);

}  // namespace pangaea
