#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/lcm/url.h"

namespace pangaea {

using LcmPayload = std::vector<std::byte>;

struct LcmMessage {
  std::string channel;
  LcmPayload payload;
};

// Messages of some channels, one after the other. One owner thread.
class LcmReceiver {
 public:
  // A log that cannot be read, or a network that cannot be joined, is an error.
  static Result<std::unique_ptr<LcmReceiver>> Open(const LcmUrl& url, const std::vector<std::string>& channels);
  virtual ~LcmReceiver() = default;

  // Waits for the next message. An error is a damaged part of a log, after which the next call goes on, or a network
  // that broke down. Nothing at the end, and nothing once `stop` is requested.
  virtual std::optional<Result<LcmMessage>> Next(const std::stop_token& stop) = 0;
  virtual bool is_live() const = 0;
};

}  // namespace pangaea
