#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <stop_token>
#include <thread>

#include "agent/runtime/stage_clock.h"
#include "common/base/bounded_queue.h"
#include "common/sensor/dataset.h"

namespace pangaea {

// How fast a recorded dataset is played.
struct PlayRate {
  // Of the recording's own speed; 1 is real time. Where the agent is too slow the newest waiting frame wins and the
  // others are dropped. 0: as fast as the agent can, no frame is dropped.
  double speed = 1.0;

  bool waits_for_agent() const { return speed == 0.0; }
};

// One instant's images. The right one is decoded only when it is asked for.
struct SourceFrame {
  std::int64_t stamp_ns = 0;
  cv::Mat left;                 // as recorded: not rectified
  std::filesystem::path right;  // empty: monocular
};

// What happened to frames that never reached tracking.
struct SourceCounters {
  std::size_t frames = 0;   // of the dataset
  std::size_t dropped = 0;  // the agent was too slow
  std::size_t skipped = 0;  // the image could not be read
};

// Plays a dataset's left images from a thread of its own. Next() belongs to one consumer thread.
class FrameSource {
 public:
  // `dataset` outlives the source.
  FrameSource(const Dataset& dataset, PlayRate rate);
  ~FrameSource();

  // Waits for the next frame; nothing after the last one, or after Stop.
  std::optional<SourceFrame> Next();
  // Ends the play; any thread.
  void Stop();
  // After Next() returned nothing.
  SourceCounters counters() const { return counters_; }
  const StageClock& stages() const { return stages_; }

 private:
  void Play(const std::stop_token& stop);
  bool WaitUntilDue(std::int64_t stamp_ns, std::chrono::steady_clock::time_point start, const std::stop_token& stop);
  void Deliver(SourceFrame frame);

  const Dataset& dataset_;
  const PlayRate rate_;
  BoundedQueue<SourceFrame> queue_;
  SourceCounters counters_;
  StageClock stages_;
  std::jthread thread_;  // last: it uses all the others
};

}  // namespace pangaea
