#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "agent/runtime/stage_clock.h"
#include "common/base/bounded_queue.h"
#include "common/sensor/frame_stream.h"

namespace pangaea {

// How fast a recording is played. A live stream sets its own pace.
struct PlayRate {
  // Of the recording's own speed; 1 is real time. Where the agent is too slow the newest waiting frame wins and the
  // others are dropped. 0: as fast as the agent can, no frame is dropped.
  double speed = 1.0;

  bool waits_for_agent() const { return speed == 0.0; }
};

// One instant's images. The right one is decoded only when it is asked for.
struct SourceFrame {
  std::int64_t stamp_ns = 0;
  cv::Mat left;             // as recorded: not rectified
  ImageLoader right;        // empty: monocular
  std::size_t dropped = 0;  // frames so far that the agent was too slow for
};

// What happened to frames that never reached tracking.
struct SourceCounters {
  std::size_t frames = 0;   // of the recording; of a stream without a known end, those that came
  std::size_t dropped = 0;  // the agent was too slow
  std::size_t skipped = 0;  // what came could not be read, was not newer than the frame before, or repeats it
  std::size_t missing = 0;  // were sent and never arrived
};

// Plays the left images of a stream from a thread of its own. Next() belongs to one consumer thread.
class FrameSource {
 public:
  // `stream` outlives the source.
  FrameSource(FrameStream& stream, PlayRate rate);
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
  bool WaitUntilDue(std::int64_t stamp_ns, const std::stop_token& stop);
  void Handle(const StreamFrame& frame);
  void Skip(const std::string& why);
  void Deliver(SourceFrame frame);

  FrameStream& stream_;
  const PlayRate rate_;
  BoundedQueue<SourceFrame> queue_;
  std::chrono::steady_clock::time_point start_;
  std::optional<std::int64_t> first_stamp_ns_;
  std::optional<std::int64_t> latest_stamp_ns_;
  SourceCounters counters_;
  StageClock stages_;
  std::jthread thread_;  // last: it uses all the others
};

}  // namespace pangaea
