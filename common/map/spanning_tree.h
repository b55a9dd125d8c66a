#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "common/map/atlas.h"
#include "common/map/edits/move_keyframes.h"
#include "common/map/edits/move_landmarks.h"

namespace pangaea {

// Number of edges up to the root; 0 for a root and for an unknown id.
std::size_t TreeDepth(const Atlas& atlas, KeyframeId id);
// Whether `ancestor` is `id` or lies on its way up to the root.
bool IsAncestorOrSelf(const Atlas& atlas, KeyframeId ancestor, KeyframeId id);
// All keyframes of a map, each parent before its children; level by level, ascending within the children of one.
std::vector<KeyframeId> ParentsFirst(const Atlas& atlas, MapId map);
// The same for some keyframes: by depth, then by id. Unknown ids are left out, equal ones listed once.
std::vector<KeyframeId> ParentsFirst(const Atlas& atlas, std::span<const KeyframeId> keyframes);

// The edit that gives keyframes these poses (camera_from_map), to be applied to the given atlas or one in which the
// same keyframes hang together in the same way. Unknown ids are left out; of an id listed twice the last pose counts.
MoveKeyframes MoveKeyframesTo(const Atlas& atlas, std::span<const std::pair<KeyframeId, Rigid3d>> camera_from_map);
// The edit that gives landmarks these positions (point_in_map), to within QuantizePoint, measured from their reference
// keyframes as they stand in the given atlas: where keyframes move as well, apply their edit first. Left out are
// unknown ids and points that an edit cannot carry: behind the reference camera or farther than kMaxLength.
MoveLandmarks MoveLandmarksTo(const Atlas& atlas, std::span<const std::pair<LandmarkId, Eigen::Vector3d>> point_in_map);

}  // namespace pangaea
