#pragma once

#include <cstdint>

#include "common/geometry/rigid3.h"

namespace pangaea {

// Where the body was at one instant: one line of a trajectory.
struct StampedPose {
  std::int64_t stamp_ns = 0;  // nanoseconds in the clock of the dataset
  Rigid3d world_from_body;
};

}  // namespace pangaea
