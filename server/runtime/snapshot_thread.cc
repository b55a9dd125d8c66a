#include "server/runtime/snapshot_thread.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <utility>

#include "server/runtime/thread_priority.h"
#include "server/runtime/unix_clock.h"

namespace pangaea {
namespace {

// Not the lowest: a commit waits while the store is written here, and must not wait for a thread that never runs.
constexpr int kNice = 2;

}  // namespace

SnapshotThread::SnapshotThread(SnapshotStore store, const SnapshotTriggers& triggers, std::uint64_t snapshot_position,
                               std::uint64_t pending)
    : store_(std::move(store)), triggers_(triggers), pending_envelopes_(pending) {
  report_.position = snapshot_position;
}

SnapshotThread::~SnapshotThread() { Stop(); }

void SnapshotThread::Start() {
  thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
}

void SnapshotThread::Stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void SnapshotThread::Restart(SnapshotStore store, std::uint64_t snapshot_position) {
  store_ = std::move(store);
  {
    MutexLock lock(mutex_);
    orders_.clear();
    due_ordered_ = false;
    pending_envelopes_ = pending_bytes_ = 0;
    report_.position = snapshot_position;
  }
  Start();
}

void SnapshotThread::Committed(const Atlas& atlas, std::uint64_t position, std::uint64_t envelopes,
                               std::uint64_t bytes) {
  MutexLock lock(mutex_);
  pending_envelopes_ += envelopes;
  pending_bytes_ += bytes;
  if (pending_envelopes_ < triggers_.envelopes && pending_bytes_ < triggers_.bytes) return;
  if (due_ordered_) return;
  pending_envelopes_ = pending_bytes_ = 0;
  due_ordered_ = true;
  orders_.push_back({atlas, position, false});
  ordered_.notify_one();
}

void SnapshotThread::Keep(Atlas atlas, std::uint64_t position) {
  MutexLock lock(mutex_);
  const auto waits = [](const Order& order) { return order.keep; };
  if (std::ranges::count_if(orders_, waits) >= static_cast<std::ptrdiff_t>(kMaxWaiting)) {
    orders_.erase(std::ranges::find_if(orders_, waits));
  }
  orders_.push_back({std::move(atlas), position, true});
  ordered_.notify_one();
}

SnapshotReport SnapshotThread::Report() const {
  MutexLock lock(mutex_);
  return report_;
}

void SnapshotThread::Run(const std::stop_token& stop) {
  StandBack(kNice);
  while (const auto order = NextOrder(stop)) Write(*order, stop);
}

std::optional<SnapshotThread::Order> SnapshotThread::NextOrder(const std::stop_token& stop) {
  MutexLock lock(mutex_);
  ordered_.wait(mutex_, stop, [this]() REQUIRES(mutex_) { return !orders_.empty(); });
  if (stop.stop_requested()) return std::nullopt;
  Order order = std::move(orders_.front());
  orders_.pop_front();
  return order;
}

void SnapshotThread::Write(const Order& order, const std::stop_token& stop) {
  const auto begin = std::chrono::steady_clock::now();
  const Status status = order.keep ? store_.Keep(order.atlas, order.position, UnixNanoseconds(), stop)
                                   : store_.Write(order.atlas, order.position, UnixNanoseconds(), stop);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  if (status) {
    spdlog::info("snapshot of {} keyframes {} in {:.2f} s", order.atlas.keyframe_count(),
                 order.keep ? "kept" : "written", took.count());
  } else if (!stop.stop_requested()) {
    spdlog::warn("no snapshot: {}; the journal goes on growing", status.error().message);
  }
  MutexLock lock(mutex_);
  if (!order.keep) due_ordered_ = false;
  if (!status && stop.stop_requested()) return;  // given up: no error
  report_.error = status ? std::string() : status.error().message;
  if (!status || order.keep) return;
  report_.position = order.position;
  report_.seconds = took.count();
  ++report_.written;
}

}  // namespace pangaea
