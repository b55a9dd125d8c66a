#pragma once

#include <functional>
#include <string>
#include <thread>

#include "common/base/bounded_queue.h"
#include "common/base/result.h"
#include "common/wire/undo.h"

namespace pangaea {

// Takes causes back as operators ask for it, one after the other: on a thread of its own, because the server's work has
// to come to rest first.
class UndoThread {
 public:
  struct Links {
    std::function<Result<std::string>(const std::string& cause)> undo;  // on this thread: what was done, in words
    std::function<void(const UndoAnswer&)> answer;                      // on this thread
  };
  explicit UndoThread(Links links) : links_(std::move(links)), queue_(kWaiting) {}
  ~UndoThread() { Stop(); }

  void Start();
  // Finishes the one it is at; those that wait get no answer.
  void Stop();
  // Any thread. One that comes when too many wait is answered with an error.
  void Take(UndoRequest request);

 private:
  static constexpr std::size_t kWaiting = 8;
  void Run(const std::stop_token& stop);

  const Links links_;
  BoundedQueue<UndoRequest> queue_;
  std::jthread thread_;
};

}  // namespace pangaea
