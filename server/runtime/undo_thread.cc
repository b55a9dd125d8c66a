#include "server/runtime/undo_thread.h"

#include <spdlog/spdlog.h>

#include <utility>

namespace pangaea {

void UndoThread::Start() {
  thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
}

void UndoThread::Stop() {
  thread_.request_stop();
  queue_.Close();
  if (thread_.joinable()) thread_.join();
}

void UndoThread::Take(UndoRequest request) {
  const std::uint64_t number = request.request;
  if (!queue_.TryPush(std::move(request))) links_.answer({number, false, "too many requests wait"});
}

void UndoThread::Run(const std::stop_token& stop) {
  while (auto request = queue_.Pop()) {
    if (stop.stop_requested()) return;
    spdlog::info("asked to undo {}", request->cause);
    const auto done = links_.undo(request->cause);
    if (!done) spdlog::warn("{} was not undone: {}", request->cause, done.error().message);
    links_.answer({request->request, done.has_value(), done ? *done : done.error().message});
  }
}

}  // namespace pangaea
