#pragma once

#include <optional>

#include "common/geometry/rigid3.h"
#include "common/geometry/similarity3.h"

namespace pangaea {

// Where the body is, said twice: smoothly, and in the map.
struct OdometryState {
  // Moves as the body moves; no correction of the map makes it jump. Lengths in units of the first map.
  Rigid3d odom_from_body;
  // What corrections do. Its scale is 1 for metric maps.
  Similarity3d map_from_odom;
  // The motion since the state before is not known: a new map began.
  bool discontinuity = false;
};

// Sums up the motions between tracked frames, each measured in one snapshot of the map, before and after which the map
// may have jumped.
class Odometry {
 public:
  explicit Odometry(const Rigid3d& camera_from_body) : camera_from_body_(camera_from_body) {}

  // A tracked frame. `current_from_previous` (camera) is the motion since the frame tracked before, in map units; none
  // where it is not known. `scale`: by how much corrections have multiplied the lengths of the map (Keyframe::scale).
  const OdometryState& Update(const Rigid3d& camera_from_map, const std::optional<Rigid3d>& current_from_previous,
                              double scale);
  const OdometryState& state() const { return state_; }

 private:
  const Rigid3d camera_from_body_;
  OdometryState state_;
  bool started_ = false;
};

}  // namespace pangaea
