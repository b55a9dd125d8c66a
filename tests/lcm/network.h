#pragma once

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include "common/lcm/receiver.h"
#include "common/lcm/sender.h"

namespace pangaea::testing {

// Asks for a stop after a while, so that a test whose messages are lost ends.
class Deadline {
 public:
  explicit Deadline(std::chrono::seconds patience)
      : thread_([this, patience](const std::stop_token& over) {
          std::unique_lock lock(mutex_);
          if (!never_.wait_for(lock, over, patience, [] { return false; }) && !over.stop_requested()) {
            passed_.request_stop();
          }
        }) {}

  std::stop_token token() const { return passed_.get_token(); }

 private:
  std::mutex mutex_;
  std::condition_variable_any never_;
  std::stop_source passed_;
  std::jthread thread_;
};

// An LCM network on this machine alone; each process has another port.
inline std::string OwnNetwork() {
  return "udpm://239.255.76.67:" + std::to_string(20000 + getpid() % 20000) + "?ttl=0";
}

// Multicast needs a route: `ip route add 224.0.0.0/4 dev lo` where only loopback is up.
inline bool MulticastWorks() {
  const auto url = LcmUrl::Parse(OwnNetwork());
  const auto receiver = LcmReceiver::Open(*url, {"PROBE"});
  const auto sender = LcmSender::Open(*url);
  if (!receiver || !sender) return false;
  const std::byte octet{1};
  const Deadline deadline(std::chrono::seconds(3));
  return (*sender)->Send("PROBE", std::span(&octet, 1), 0) && (*receiver)->Next(deadline.token()).has_value();
}

inline constexpr const char* kNoMulticast = "multicast does not work here; try: ip route add 224.0.0.0/4 dev lo";

}  // namespace pangaea::testing
