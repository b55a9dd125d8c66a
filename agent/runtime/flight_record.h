#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "agent/tracking/tracker.h"
#include "common/geometry/stamped_pose.h"
#include "common/map/atlas.h"

namespace pangaea {

// What the process held in memory at some time of the flight.
struct MemorySample {
  double seconds = 0.0;  // since the first frame, by the stamps of the images
  double resident_mib = 0.0;
};

// What became of the frames.
struct FlightRecord {
  std::size_t tracked = 0;                   // frames whose pose was refined in a map
  std::size_t lost = 0;                      // frames that were processed and not tracked
  std::vector<StampedPose> live_trajectory;  // map_from_body as known at its frame
  std::vector<MemorySample> memory;          // every half minute

  std::size_t frames() const { return tracked + lost; }
};

// Whether the frame is the first one of a map.
bool BeginsMap(const TrackingResult& result);

// Keeps the record of a flight, and says in the log how it goes. One thread.
class FlightRecorder {
 public:
  // `name` is the agent's; `frame_count`: of the whole flight, where that is known.
  FlightRecorder(SessionId session, std::string name, std::optional<std::size_t> frame_count,
                 const Rigid3d& camera_from_body)
      : session_(session), name_(std::move(name)), frame_count_(frame_count), camera_from_body_(camera_from_body) {}

  // The next frame; `atlas` is what it was tracked in.
  void Take(std::int64_t stamp_ns, const TrackingResult& result, const Atlas& atlas);

  const FlightRecord& record() const { return record_; }

 private:
  using Clock = std::chrono::steady_clock;

  void Count(std::int64_t stamp_ns, const TrackingResult& result);
  void SayWhatChanged(const TrackingResult& result);
  void SampleMemory(std::int64_t stamp_ns);
  void SayVergence(const TrackingResult& result, const Atlas& atlas);
  void SayProgress(const Atlas& atlas);

  const SessionId session_;
  const std::string name_;
  const std::optional<std::size_t> frame_count_;
  const Rigid3d camera_from_body_;
  FlightRecord record_;
  TrackingState state_ = TrackingState::kStarting;  // of the latest frame
  double vergence_ = 0.0;                           // that was said
  std::optional<std::int64_t> first_stamp_ns_;
  Clock::time_point latest_progress_ = Clock::now();
};

}  // namespace pangaea
