#pragma once

#include <memory>
#include <string>

#include "common/base/result.h"
#include "common/lcm/channels.h"
#include "common/lcm/sender.h"
#include "common/wire/agent_state.h"

namespace pangaea {

// Tells on LCM where an agent is and how it does: tracking_state_t and statistics_t for each state, pose_t where it is
// tracking. One thread.
class LcmOutput {
 public:
  // `url` as of url.h: a network or a log.
  static Result<LcmOutput> Open(const std::string& url, const LcmChannels& channels);

  Status Publish(const AgentState& state);
  Status Close() { return sender_->Close(); }

 private:
  LcmOutput(std::unique_ptr<LcmSender> sender, LcmChannels channels)
      : sender_(std::move(sender)), channels_(std::move(channels)) {}

  std::unique_ptr<LcmSender> sender_;
  LcmChannels channels_;
};

}  // namespace pangaea
