#pragma once

#include <memory>
#include <utility>

#include "common/base/mutex.h"

namespace pangaea {

// One pointer to an immutable value, replaced by its owner and read by anyone. Readers keep what they got for as long
// as they hold it. A mutex and not std::atomic<shared_ptr>: ThreadSanitizer misreads the latter in GCC 12.
template <typename T>
class Published {
 public:
  explicit Published(std::shared_ptr<const T> value) : value_(std::move(value)) {}

  void Set(std::shared_ptr<const T> value) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    value_.swap(value);  // the old value is released after the lock
  }

  std::shared_ptr<const T> Get() const EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    return value_;
  }

 private:
  mutable Mutex mutex_;
  std::shared_ptr<const T> value_ GUARDED_BY(mutex_);
};

}  // namespace pangaea
