#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "common/base/mutex.h"
#include "common/map/atlas.h"
#include "server/storage/snapshot_store.h"

namespace pangaea {

// How the snapshots go, for the status.
struct SnapshotReport {
  std::uint64_t position = 0;  // of the newest one; 0 before any
  double seconds = 0.0;        // it took
  std::uint64_t written = 0;   // since the start
  std::string error;           // of the last attempt; empty where it went well
};

struct SnapshotTriggers {
  std::uint64_t envelopes = 0;
  std::uint64_t bytes = 0;
};

// Writes snapshots in the background.
class SnapshotThread {
 public:
  // `pending`: entries of the journal since the last snapshot.
  SnapshotThread(SnapshotStore store, const SnapshotTriggers& triggers, std::uint64_t snapshot_position,
                 std::uint64_t pending);
  ~SnapshotThread();

  void Start();
  // Gives up a snapshot that is being written.
  void Stop();
  // After Stop(), on the thread that called it: begins anew with what the store holds by now.
  void Restart(SnapshotStore store, std::uint64_t snapshot_position);

  // By the atlas thread, before Committed() of what follows: keep a snapshot of the atlas at that position. Up to
  // kMaxWaiting wait to be written; the oldest waiting one is given up for a newer one.
  void Keep(Atlas atlas, std::uint64_t position) EXCLUDES(mutex_);
  // After each commit, by the atlas thread. The atlas is copied only when a snapshot is due.
  void Committed(const Atlas& atlas, std::uint64_t position, std::uint64_t envelopes, std::uint64_t bytes)
      EXCLUDES(mutex_);
  SnapshotReport Report() const EXCLUDES(mutex_);

 private:
  static constexpr std::size_t kMaxWaiting = 4;
  struct Order {
    Atlas atlas;
    std::uint64_t position;
    bool keep;
  };
  void Run(const std::stop_token& stop);
  std::optional<Order> NextOrder(const std::stop_token& stop) EXCLUDES(mutex_);
  void Write(const Order& order, const std::stop_token& stop);

  SnapshotStore store_;  // of the thread
  const SnapshotTriggers triggers_;
  mutable Mutex mutex_;
  ConditionVariable ordered_;
  std::deque<Order> orders_ GUARDED_BY(mutex_);  // ascending by position
  bool due_ordered_ GUARDED_BY(mutex_) = false;  // a snapshot for recovery is among the orders or being written
  std::uint64_t pending_envelopes_ GUARDED_BY(mutex_);
  std::uint64_t pending_bytes_ GUARDED_BY(mutex_) = 0;
  SnapshotReport report_ GUARDED_BY(mutex_);
  std::jthread thread_;
};

}  // namespace pangaea
