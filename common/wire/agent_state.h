#pragma once

#include <cstdint>

#include "common/geometry/rigid3.h"
#include "common/geometry/similarity3.h"
#include "common/map/ids.h"

namespace pangaea {

// On the wire an integer: other values may come from newer agents.
enum class AgentTracking : std::uint32_t { kInitializing = 0, kTracking = 1, kLost = 2, kFinished = 3 };

// Where an agent is and how it does, for whoever looks. Best effort: some are lost.
struct AgentState {
  SessionId session = 0;
  std::int64_t stamp_ns = 0;  // of the newest frame
  AgentTracking tracking = AgentTracking::kInitializing;
  bool discontinuity = false;     // odom_from_body is not continuous with the previous state
  std::uint32_t map_counter = 0;  // counter of the agent's present map
  Rigid3d odom_from_body;
  Similarity3d map_from_odom;
  std::uint64_t frames = 0;
  std::uint64_t tracked = 0;
  std::uint64_t dropped = 0;
  std::uint32_t keyframes = 0;
  std::uint32_t landmarks = 0;
  float tracking_ms = 0.0F;  // of the newest frame
  float memory_mib = 0.0F;
  std::uint64_t bytes_sent = 0;
  std::uint64_t retained_edits = 0;  // envelopes not yet acknowledged
};

}  // namespace pangaea
