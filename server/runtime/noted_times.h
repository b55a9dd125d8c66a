#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "common/base/mutex.h"
#include "server/ingest/journal.h"

namespace pangaea {

// Times of work that are not in the store yet. Any thread.
class NotedTimes {
 public:
  void Note(WorkTime time) EXCLUDES(mutex_) {
    constexpr std::size_t kMostWaiting = 10'000;  // while the store takes nothing
    MutexLock lock(mutex_);
    if (times_.size() < kMostWaiting) times_.push_back(std::move(time));
  }
  std::vector<WorkTime> Take() EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    return std::exchange(times_, {});
  }

 private:
  Mutex mutex_;
  std::vector<WorkTime> times_ GUARDED_BY(mutex_);
};

}  // namespace pangaea
