#include "common/lcm/lcm_output.h"

#include <pangaea_lcm/pose_t.hpp>
#include <pangaea_lcm/statistics_t.hpp>
#include <pangaea_lcm/tracking_state_t.hpp>
#include <utility>

#include "common/lcm/message_codec.h"
#include "common/lcm/pose_codec.h"
#include "common/lcm/url.h"

namespace pangaea {
namespace {

pangaea_lcm::pose_t PoseOf(const AgentState& state) {
  pangaea_lcm::pose_t message{};
  message.session = static_cast<std::int64_t>(state.session);
  message.stamp_ns = state.stamp_ns;
  message.map_counter = static_cast<std::int32_t>(state.map_counter);
  message.discontinuity = state.discontinuity ? 1 : 0;
  message.odom_from_body = PoseMessage(state.odom_from_body);
  message.map_from_odom = PoseMessage(Rigid3d(state.map_from_odom.rotation(), state.map_from_odom.translation()));
  message.map_from_odom_scale = state.map_from_odom.scale();
  return message;
}

pangaea_lcm::tracking_state_t TrackingStateOf(const AgentState& state) {
  pangaea_lcm::tracking_state_t message{};
  message.session = static_cast<std::int64_t>(state.session);
  message.stamp_ns = state.stamp_ns;
  message.state = static_cast<std::int32_t>(state.tracking);
  return message;
}

pangaea_lcm::statistics_t StatisticsOf(const AgentState& state) {
  pangaea_lcm::statistics_t message{};
  message.session = static_cast<std::int64_t>(state.session);
  message.stamp_ns = state.stamp_ns;
  message.frames = static_cast<std::int64_t>(state.frames);
  message.tracked = static_cast<std::int64_t>(state.tracked);
  message.dropped = static_cast<std::int64_t>(state.dropped);
  message.keyframes = static_cast<std::int32_t>(state.keyframes);
  message.landmarks = static_cast<std::int32_t>(state.landmarks);
  message.tracking_ms = state.tracking_ms;
  message.memory_mib = state.memory_mib;
  message.bytes_sent = static_cast<std::int64_t>(state.bytes_sent);
  message.retained_edits = static_cast<std::int64_t>(state.retained_edits);
  return message;
}

}  // namespace

Result<LcmOutput> LcmOutput::Open(const std::string& url, const LcmChannels& channels) {
  if (auto status = channels.Check(); !status) return tl::make_unexpected(status.error());
  const auto parsed = LcmUrl::Parse(url);
  if (!parsed) return tl::make_unexpected(parsed.error());
  auto sender = LcmSender::Open(*parsed);
  if (!sender) return tl::make_unexpected(sender.error());
  return LcmOutput(std::move(*sender), channels);
}

Status LcmOutput::Publish(const AgentState& state) {
  if (state.tracking == AgentTracking::kTracking) {
    auto status = sender_->Send(channels_.pose, EncodeMessage(PoseOf(state)), state.stamp_ns);
    if (!status) return status;
  }
  auto status = sender_->Send(channels_.tracking_state, EncodeMessage(TrackingStateOf(state)), state.stamp_ns);
  if (!status) return status;
  return sender_->Send(channels_.statistics, EncodeMessage(StatisticsOf(state)), state.stamp_ns);
}

}  // namespace pangaea
