#include "common/base/stop_signals.h"

#include <cerrno>
#include <ctime>

namespace pangaea {

StopSignals::StopSignals() {
  sem_init(&arrived_, 0, 0);
  struct sigaction action {};
  action.sa_handler = [](int) { sem_post(&arrived_); };
  action.sa_flags = SA_RESTART;
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &action, &before_[i]);
}

StopSignals::~StopSignals() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &before_[i], nullptr);
}

void StopSignals::Wait() {
  while (sem_wait(&arrived_) != 0) continue;  // interrupted
}

bool StopSignals::WaitUntil(std::chrono::steady_clock::time_point due) {
  using std::chrono::seconds, std::chrono::nanoseconds, std::chrono::duration_cast;
  const auto since = due.time_since_epoch();
  const auto whole = duration_cast<seconds>(since);
  const timespec time{static_cast<std::time_t>(whole.count()),
                      static_cast<long>(duration_cast<nanoseconds>(since - whole).count())};
  int result = -1;
  do {
    if (interrupted_) return true;
    result = sem_clockwait(&arrived_, CLOCK_MONOTONIC, &time);  // the clock of std::chrono::steady_clock
  } while (result != 0 && errno == EINTR);
  interrupted_ = result == 0;
  return interrupted_;
}

}  // namespace pangaea
