#include "agent/runtime/state_teller.h"

#include <spdlog/spdlog.h>

#include "common/base/process_memory.h"

namespace pangaea {
namespace {

AgentTracking TrackingOf(const TrackingResult& result) {
  if (result.tracked) return AgentTracking::kTracking;
  return result.state == TrackingState::kLost ? AgentTracking::kLost : AgentTracking::kInitializing;
}

}  // namespace

StateTeller::StateTeller(SessionId session, const Rigid3d& camera_from_body, UplinkThread* uplink, LcmOutput* lcm)
    : uplink_(uplink), lcm_(lcm), odometry_(camera_from_body) {
  state_.session = session;
}

void StateTeller::TellFrame(std::int64_t stamp_ns, const TrackingResult& result, const Atlas& atlas,
                            const FlightRecord& record, std::size_t dropped, std::chrono::steady_clock::duration took) {
  if (!is_heard()) return;
  state_.stamp_ns = stamp_ns;
  SetPlace(result);
  state_.frames = record.frames();
  state_.tracked = record.tracked;
  state_.dropped = dropped;
  state_.keyframes = static_cast<std::uint32_t>(atlas.keyframe_count());
  state_.landmarks = static_cast<std::uint32_t>(atlas.landmark_count());
  state_.tracking_ms = std::chrono::duration<float, std::milli>(took).count();
  state_.memory_mib = ResidentMib();
  SetUplink();
  Tell();
}

void StateTeller::TellEnd() {
  if (!is_heard()) return;
  state_.tracking = AgentTracking::kFinished;
  Tell();
}

void StateTeller::SetPlace(const TrackingResult& result) {
  if (result.tracked) odometry_.Update(result.camera_from_map, result.current_from_previous, result.map_scale);
  const OdometryState& odometry = odometry_.state();
  state_.tracking = TrackingOf(result);
  state_.discontinuity = result.tracked && odometry.discontinuity;
  state_.map_counter = result.map.counter;
  state_.odom_from_body = odometry.odom_from_body;
  state_.map_from_odom = odometry.map_from_odom;
}

void StateTeller::SetUplink() {
  if (uplink_ == nullptr) return;
  const UplinkCounters counters = uplink_->counters();
  state_.bytes_sent = counters.bytes_sent;
  state_.retained_edits = counters.last_sequence - counters.acknowledged;
}

void StateTeller::Tell() {
  if (uplink_ != nullptr) uplink_->Tell(state_);
  if (lcm_ == nullptr) return;
  const Status status = lcm_->Publish(state_);
  if (!status && untold_++ == 0) spdlog::warn("the state cannot be told on LCM: {}", status.error().message);
}

}  // namespace pangaea
