#pragma once

#include <semaphore.h>
#include <signal.h>

#include <array>
#include <chrono>

namespace pangaea {

// Ctrl-C and SIGTERM, for a command that plays something in its own time: while one lives, they end the waiting instead
// of the program. At most one at a time.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  // Waits until `due`. True, at once, when the program was asked to end, and from then on.
  bool WaitUntil(std::chrono::steady_clock::time_point due);

 private:
  static constexpr std::array kSignals = {SIGINT, SIGTERM};
  static inline sem_t arrived_;  // a handler has no object
  std::array<struct sigaction, kSignals.size()> before_{};
  bool interrupted_ = false;
};

}  // namespace pangaea
