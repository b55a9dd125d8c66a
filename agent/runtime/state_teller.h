#pragma once

#include <chrono>
#include <cstddef>

#include "agent/runtime/flight_record.h"
#include "agent/runtime/uplink_thread.h"
#include "agent/tracking/odometry.h"
#include "agent/tracking/tracker.h"
#include "common/lcm/lcm_output.h"
#include "common/map/atlas.h"
#include "common/wire/agent_state.h"

namespace pangaea {

// Tells after each frame where the agent is and how it does: to the server's site, and to LCM where that was asked
// for. One thread.
class StateTeller {
 public:
  // `uplink` is null without a server, `lcm` where it was not asked for; both outlive the teller.
  StateTeller(SessionId session, const Rigid3d& camera_from_body, UplinkThread* uplink, LcmOutput* lcm);

  // A frame that was tracked, or was not, in `atlas`; `record` has it already. `dropped`: frames so far that the agent
  // was too slow for. `took`: the time for this one.
  void TellFrame(std::int64_t stamp_ns, const TrackingResult& result, const Atlas& atlas, const FlightRecord& record,
                 std::size_t dropped, std::chrono::steady_clock::duration took);
  // After the last frame.
  void TellEnd();

 private:
  bool is_heard() const { return uplink_ != nullptr || lcm_ != nullptr; }
  void SetPlace(const TrackingResult& result);
  void SetUplink();
  void Tell();

  UplinkThread* uplink_;
  LcmOutput* lcm_;
  Odometry odometry_;
  AgentState state_;  // the latest
  std::size_t untold_ = 0;
};

}  // namespace pangaea
