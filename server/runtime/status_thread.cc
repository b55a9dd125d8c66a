#include "server/runtime/status_thread.h"

#include <utility>

namespace pangaea {

StatusThread::StatusThread(const StatusOptions& options, std::function<void()> publish)
    : options_(options), publish_(std::move(publish)) {}

StatusThread::~StatusThread() { Stop(); }

void StatusThread::Start() {
  thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
}

void StatusThread::Stop() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
  publish_();
}

void StatusThread::Notify() {
  MutexLock lock(mutex_);
  changed_ = true;
  news_.notify_one();
}

void StatusThread::Run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    publish_();
    WaitForNews(stop);
  }
}

void StatusThread::WaitForNews(const std::stop_token& stop) {
  MutexLock lock(mutex_);
  (void)news_.wait_for(mutex_, stop, options_.shortest_interval, [] { return false; });
  const auto rest = options_.longest_interval - options_.shortest_interval;
  (void)news_.wait_for(mutex_, stop, rest, [this]() REQUIRES(mutex_) { return changed_; });
  changed_ = false;
}

}  // namespace pangaea
