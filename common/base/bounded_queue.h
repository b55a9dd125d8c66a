#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <optional>
#include <utility>

#include "common/base/check.h"
#include "common/base/mutex.h"

namespace pangaea {

// A queue between threads that never holds more than `capacity` items. What happens when it is full is the caller's
// choice at each push: wait (Push), give the item back (TryPush), or displace the oldest (PushNewest).
// Every member function may be called from any thread.
template <typename T>
class BoundedQueue {
 public:
  explicit BoundedQueue(std::size_t capacity) : capacity_(capacity) { PANGAEA_CHECK(capacity > 0); }

  // Waits for room. False when the queue was closed: the item was not taken.
  [[nodiscard]] bool Push(T item) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    while (items_.size() >= capacity_ && !closed_) room_.wait(mutex_);
    return Append(std::move(item));
  }

  // False when the queue is full or closed: the item was not taken.
  [[nodiscard]] bool TryPush(T item) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    return items_.size() < capacity_ && Append(std::move(item));
  }

  // Never waits: a full queue gives up its oldest item. Returns how many items were displaced (0 or 1).
  std::size_t PushNewest(T item) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    const std::size_t displaced = items_.size() >= capacity_ ? 1 : 0;
    if (displaced != 0) items_.pop_front();
    Append(std::move(item));
    return displaced;
  }

  // Waits for an item. Nothing when the queue is closed and empty.
  std::optional<T> Pop() EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    while (items_.empty() && !closed_) filled_.wait(mutex_);
    return Take();
  }

  // As Pop, but gives up at `deadline`: then nothing, too.
  std::optional<T> PopUntil(std::chrono::steady_clock::time_point deadline) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    while (items_.empty() && !closed_) {
      if (filled_.wait_until(mutex_, deadline) == std::cv_status::timeout) break;
    }
    return Take();
  }

  std::optional<T> TryPop() EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    return Take();
  }

  // No further pushes; what is queued can still be popped, then Pop returns nothing.
  void Close() EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    closed_ = true;
    filled_.notify_all();
    room_.notify_all();
  }

  std::size_t size() const EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    return items_.size();
  }

 private:
  bool Append(T item) REQUIRES(mutex_) {
    if (closed_) return false;
    items_.push_back(std::move(item));
    filled_.notify_one();
    return true;
  }

  std::optional<T> Take() REQUIRES(mutex_) {
    if (items_.empty()) return std::nullopt;
    std::optional<T> item(std::move(items_.front()));
    items_.pop_front();
    room_.notify_one();
    return item;
  }

  const std::size_t capacity_;
  mutable Mutex mutex_;
  ConditionVariable filled_;
  ConditionVariable room_;
  std::deque<T> items_ GUARDED_BY(mutex_);
  bool closed_ GUARDED_BY(mutex_) = false;
};

}  // namespace pangaea
