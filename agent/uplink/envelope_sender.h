#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include "agent/uplink/retained_edits.h"
#include "common/base/result.h"
#include "common/wire/envelope.h"

namespace pangaea {

// Sends the envelopes that RetainedEdits gives, in their order, and after a write that peers did not take waits before
// the next one. Not thread-safe; owned by the uplink thread.
class EnvelopeSender {
 public:
  using Time = RetainedEdits::Time;
  using Write = std::function<Status(const Envelope&)>;  // may block
  using Now = std::function<Time()>;                     // any steady clock

  // After a write that peers did not take: about what it blocked for, once more.
  static constexpr std::chrono::milliseconds kPause{200};

  EnvelopeSender(Write write, Now now) : write_(std::move(write)), now_(std::move(now)) {}

  // Sends until nothing may be sent, or a write fails. The error of that write, or of the spill sink; nothing while the
  // pause after one lasts.
  Status Send(RetainedEdits& retained);
  // Peers came, went or answered: the next Send tries at once.
  void EndPause() { pause_end_.reset(); }
  // When Send should be called next; none without a pause.
  std::optional<Time> deadline() const { return pause_end_; }

  std::uint64_t envelopes() const { return envelopes_; }
  std::uint64_t bytes() const { return bytes_; }  // octets of edits, resent ones included

 private:
  Write write_;
  Now now_;
  std::optional<Time> pause_end_;
  std::uint64_t envelopes_ = 0;
  std::uint64_t bytes_ = 0;
};

}  // namespace pangaea
