#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/mutex.h"
#include "common/map/ids.h"
#include "server/ingest/journal.h"
#include "server/runtime/latency_window.h"
#include "server/runtime/stopwatch.h"
#include "server/runtime/unix_clock.h"

namespace pangaea {

// A merge or loop, or one that was refused, for the status.
struct WeldReport {
  std::string cause;  // "merge 17"; empty where it was refused
  bool merge = false;
  std::vector<SessionId> sessions;  // of the two keyframes
  std::string text;                 // the evidence, or why not
  double milliseconds = 0.0;        // from its turn until it was durable
  std::int64_t unix_ns = 0;
};

// What recognition, welding and optimisation did since the start, and do.
struct WorkReport {
  static constexpr std::size_t kWelds = 16;
  static constexpr std::uint64_t kNever = ~std::uint64_t{0};  // no version of an atlas

  std::uint64_t looked_up_version = 0;  // of the atlas: all of its keyframes were looked up, its maps compared
  std::size_t looked_up_living = 0;     // sessions that lived then: a map is compared when nobody works on it
  std::uint64_t planned_version = 0;    // of the atlas: its maps were judged whether they are due for optimisation
  std::size_t planned_living = 0;       // sessions that lived then: what they work on is not made smaller
  bool economizing = false;
  bool welding = false;
  std::size_t lookups_waiting = 0;
  std::size_t matches_waiting = 0;
  std::size_t optimizations_waiting = 0;
  std::uint64_t recognized = 0;
  std::uint64_t merges = 0;
  std::uint64_t loops = 0;
  std::uint64_t refused = 0;
  std::uint64_t cancelled_optimizations = 0;
  std::uint64_t culled = 0;            // keyframes and landmarks, by economy and under the memory budget
  std::uint64_t fused = 0;             // by economy: duplicates that became one,
  std::uint64_t culled_landmarks = 0;  // weak landmarks that went,
  std::uint64_t culled_keyframes = 0;  // redundant keyframes that went
  std::uint64_t relocalized = 0;       // frames of lost agents that were found
  std::uint64_t not_relocalized = 0;   // ... and that were not
  std::optional<MapId> optimizing;     // whose global bundle adjustment runs
  std::deque<WeldReport> welds;        // the newest last
  std::deque<WeldReport> refusals;     // the newest last
  LatencyWindow recognition_ms;        // of a keyframe
  LatencyWindow relocalization_ms;     // of a lost agent's frame, found or not
  LatencyWindow merge_ms;              // from the match's turn until it was durable, without the pose graph
  LatencyWindow loop_ms;               // with it
  LatencyWindow pose_graph_ms;
  LatencyWindow global_ms;  // of those that came to their end

  // Whether something is under way that may change an atlas of this version.
  bool IsUnderWay(std::uint64_t version) const {
    return looked_up_version != version || planned_version != version || welding || matches_waiting > 0 ||
           optimizations_waiting > 0 || optimizing.has_value() || economizing;
  }
  // ... or that is due because other sessions live by now.
  bool IsUnderWay(std::uint64_t version, std::size_t living) const {
    return IsUnderWay(version) || planned_living != living || looked_up_living != living;
  }

  void Remember(std::deque<WeldReport>& list, WeldReport report) {
    list.push_back(std::move(report));
    if (list.size() > kWelds) list.pop_front();
  }
};

// The report, written by the threads that do the work.
class WorkLedger {
 public:
  // `written` is called after each change, `keep` with each time that was taken, on the thread that did so.
  explicit WorkLedger(
      std::function<void()> written = [] {}, std::function<void(WorkTime)> keep = [](const WorkTime&) {})
      : written_(std::move(written)), keep_(std::move(keep)) {}

  template <typename Change>
  void Write(Change&& change) EXCLUDES(mutex_) {
    {
      MutexLock lock(mutex_);
      change(report_);
    }
    written_();
  }
  // What took from the watch's construction until now: for the store. The report is Write's.
  void Keep(const char* kind, const Stopwatch& watch) {
    keep_({kind, watch.milliseconds(), watch.cpu_milliseconds(), UnixNanoseconds()});
  }
  WorkReport Read() const EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    return report_;
  }

 private:
  const std::function<void()> written_;
  const std::function<void(WorkTime)> keep_;
  mutable Mutex mutex_;
  WorkReport report_ GUARDED_BY(mutex_);
};

}  // namespace pangaea
