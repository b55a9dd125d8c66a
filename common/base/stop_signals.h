#pragma once

#include <semaphore.h>
#include <signal.h>

#include <array>
#include <chrono>

namespace pangaea {

// Ctrl-C and SIGTERM: while one of these lives, they end its waiting instead of the program. At most one at a time. A
// handler, because blocking the signals for sigwait would not reach threads that libraries start before main (OpenBLAS
// does): such a thread would take the signal, and the program would die of it.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  // Until the next signal: each ends one wait.
  void Wait();
  // Waits until `due`. True, at once, when the program was asked to end, and from then on.
  bool WaitUntil(std::chrono::steady_clock::time_point due);
  // Any thread: as a signal would.
  void Post() { sem_post(&arrived_); }

 private:
  static constexpr std::array kSignals = {SIGINT, SIGTERM};
  static inline sem_t arrived_;  // a handler has no object
  std::array<struct sigaction, kSignals.size()> before_{};
  bool interrupted_ = false;
};

}  // namespace pangaea
