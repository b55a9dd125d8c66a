#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/rigid3.h"
#include "common/map/atlas.h"

namespace pangaea {

// The latest tracked frame, from which the next one is predicted. Lengths are those that the map had then, until
// FollowScale.
struct LatestFrame {
  KeyframeId reference;
  Rigid3d reference_from_frame;
  double scale = 1.0;  // of the reference, at which the lengths here are measured
  std::int64_t stamp_ns = 0;
  Vector6d velocity = Vector6d::Zero();           // of the camera into this frame: a twist, per second
  std::vector<Eigen::Vector3d> points_in_camera;  // of the tracked landmarks

  // A correction may have scaled the map: brings the lengths along.
  void FollowScale(const Atlas& atlas);
  // camera_from_map, as the map is now; nothing where the reference is not known to it.
  std::optional<Rigid3d> PoseIn(const Atlas& atlas) const;
  // How the camera has moved until `later_ns`, if it went on as it did: later_from_frame.
  Rigid3d MotionUntil(std::int64_t later_ns) const;
  // The velocity of the camera into a later frame of `map`; zero where this frame is not of that map. The same frame,
  // found in another map, keeps its velocity.
  Vector6d VelocityInto(std::int64_t later_ns, const Rigid3d& camera_from_map, MapId map, const Atlas& atlas) const;
};

}  // namespace pangaea
