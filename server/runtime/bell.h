#pragma once

#include <chrono>
#include <stop_token>

#include "common/base/mutex.h"

namespace pangaea {

// Wakes the one thread that waits for it. Ringing again before it wakes changes nothing.
class Bell {
 public:
  // Any thread.
  void Ring() EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    rung_ = true;
    ringing_.notify_one();
  }
  // False when a stop was requested.
  bool Wait(const std::stop_token& stop) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    ringing_.wait(mutex_, stop, [this]() REQUIRES(mutex_) { return rung_; });
    rung_ = false;
    return !stop.stop_requested();
  }
  // Wakes also after `longest`.
  bool WaitFor(const std::stop_token& stop, std::chrono::milliseconds longest) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    ringing_.wait_for(mutex_, stop, longest, [this]() REQUIRES(mutex_) { return rung_; });
    rung_ = false;
    return !stop.stop_requested();
  }
  // As Ring, for what cannot wait: ends a rest, too.
  void RingNow() EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    rung_ = urgent_ = true;
    ringing_.notify_one();
  }
  // Does not listen for that long, except to what cannot wait. False when a stop was requested.
  bool Rest(const std::stop_token& stop, std::chrono::milliseconds duration) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    ringing_.wait_for(mutex_, stop, duration, [this]() REQUIRES(mutex_) { return urgent_; });
    urgent_ = false;
    return !stop.stop_requested();
  }

 private:
  Mutex mutex_;
  ConditionVariable ringing_;
  bool rung_ GUARDED_BY(mutex_) = false;
  bool urgent_ GUARDED_BY(mutex_) = false;
};

}  // namespace pangaea
