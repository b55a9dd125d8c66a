#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/rigid3.h"
#include "common/map/atlas.h"

namespace pangaea {

struct TrajectoryPose {
  std::int64_t stamp_ns = 0;
  MapId map;
  Rigid3d map_from_camera;
};

// Every tracked frame of a session, keyframes among them, each through the keyframe that holds it and with its share of
// what became of the next one (FrameCorrection), so where it is by the latest knowledge; ascending by stamp, each stamp
// once. Of one map or of all.
std::vector<TrajectoryPose> SessionTrajectory(const Atlas& atlas, SessionId session,
                                              std::optional<MapId> map = std::nullopt);

}  // namespace pangaea
