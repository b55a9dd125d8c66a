#pragma once

#include <optional>
#include <utility>

#include "common/base/mutex.h"
#include "common/wire/relocalization.h"

namespace pangaea {

// The newest answer of the server to a lost agent, until tracking takes it: one that found the place is not replaced by
// one that did not. Any thread.
class AnswerSlot {
 public:
  void Put(const RelocalizationAnswer& answer) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    if (!answer_ || answer.found || !answer_->found) answer_ = answer;
  }
  std::optional<RelocalizationAnswer> Take() EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    return std::exchange(answer_, std::nullopt);
  }

 private:
  Mutex mutex_;
  std::optional<RelocalizationAnswer> answer_ GUARDED_BY(mutex_);
};

}  // namespace pangaea
