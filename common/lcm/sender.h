#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "common/base/result.h"
#include "common/lcm/url.h"

namespace pangaea {

// Where messages go. One owner thread.
class LcmSender {
 public:
  // A log file is made anew, an existing one replaced.
  static Result<std::unique_ptr<LcmSender>> Open(const LcmUrl& url);
  virtual ~LcmSender() = default;

  // `stamp_ns` is when it happened: a log keeps it, and lcm-logplayer plays it at that pace.
  virtual Status Send(const std::string& channel, std::span<const std::byte> payload, std::int64_t stamp_ns) = 0;
  // After the last message: says whether all of it was written.
  virtual Status Close() = 0;
  virtual bool is_live() const = 0;
};

}  // namespace pangaea
