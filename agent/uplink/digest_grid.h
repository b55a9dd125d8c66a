#pragma once

#include <vector>

#include "common/map/atlas.h"
#include "common/map/edits/edits.h"

namespace pangaea {

// Whether both give the same numbers in Digest() (common/map/digest.h).
bool OnSameGrid(const Rigid3d& camera_from_map, const Rigid3d& other_camera_from_map);
bool OnSameGrid(const Eigen::Vector3d& point_in_map, const Eigen::Vector3d& other_point_in_map);

// What still keeps the digests of two atlases with the same keyframes apart after everything was sent: numbers within
// rounding of a boundary of the digest's grid, and landmarks whose position no edit can carry (behind their reference
// camera). Moves the former a few micrometres on both sides until they agree, removes the latter on both sides. What
// the server has placed by a correction is where the mirror has it: the agent follows, and lets go what the mirror has
// no more of other sessions' landmarks. Appends what it applied to the mirror to `edits`, and returns what the agent
// has to apply to its atlas.
std::vector<MapEdit> AgreeOnDigest(SessionId session, const Atlas& agent, Atlas& mirror, std::vector<MapEdit>& edits);

}  // namespace pangaea
