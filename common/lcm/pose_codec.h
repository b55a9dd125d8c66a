#pragma once

#include <optional>
#include <pangaea_lcm/rigid_pose_t.hpp>

#include "common/geometry/rigid3.h"

namespace pangaea {

pangaea_lcm::rigid_pose_t PoseMessage(const Rigid3d& pose);
// With exactly the message's numbers where they are one of ours; a quaternion that others rounded is normalised.
// Nothing for what is no rigid motion.
std::optional<Rigid3d> RigidOf(const pangaea_lcm::rigid_pose_t& message);

}  // namespace pangaea
