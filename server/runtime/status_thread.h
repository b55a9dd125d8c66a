#pragma once

#include <functional>
#include <stop_token>
#include <thread>

#include "common/base/mutex.h"
#include "server/runtime/server_options.h"

namespace pangaea {

// Calls `publish` when there is news, not more often than the shortest interval, and without news once every longest.
class StatusThread {
 public:
  StatusThread(const StatusOptions& options, std::function<void()> publish);
  ~StatusThread();

  void Start();
  // After a last call.
  void Stop();
  // Any thread.
  void Notify() EXCLUDES(mutex_);

 private:
  void Run(const std::stop_token& stop);
  void WaitForNews(const std::stop_token& stop) EXCLUDES(mutex_);

  const StatusOptions options_;
  const std::function<void()> publish_;
  Mutex mutex_;
  ConditionVariable news_;
  bool changed_ GUARDED_BY(mutex_) = false;
  std::jthread thread_;
};

}  // namespace pangaea
