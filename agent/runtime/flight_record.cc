#include "agent/runtime/flight_record.h"

#include <spdlog/spdlog.h>

#include <numbers>
#include <utility>

#include "common/base/process_memory.h"

namespace pangaea {

bool BeginsMap(const TrackingResult& result) { return result.opening != nullptr || result.root.has_value(); }

void FlightRecorder::Take(std::int64_t stamp_ns, const TrackingResult& result, const Atlas& atlas) {
  Count(stamp_ns, result);
  SayWhatChanged(result);
  SampleMemory(stamp_ns);
  SayVergence(result, atlas);
  SayProgress(atlas);
}

void FlightRecorder::Count(std::int64_t stamp_ns, const TrackingResult& result) {
  ++(result.tracked ? record_.tracked : record_.lost);
  // Known now, not then.
  record_.tracked += result.earlier_frames.size();
  record_.lost -= result.earlier_frames.size();
  if (!result.tracked) return;
  record_.live_trajectory.push_back({stamp_ns, result.camera_from_map.Inverse() * camera_from_body_});
}

void FlightRecorder::SayWhatChanged(const TrackingResult& result) {
  if (result.state == TrackingState::kLost && state_ != TrackingState::kLost) spdlog::warn("lost the camera");
  if (result.state == TrackingState::kTracking && state_ == TrackingState::kStarting) {
    spdlog::info("started the first map");
  }
  if (result.state == TrackingState::kTracking && state_ == TrackingState::kLost) {
    spdlog::info(BeginsMap(result) ? "started a new map" : "found the camera again");
  }
  state_ = result.state;
}

void FlightRecorder::SampleMemory(std::int64_t stamp_ns) {
  constexpr double kBetweenSamples = 30.0;
  if (!first_stamp_ns_) first_stamp_ns_ = stamp_ns;
  const double seconds = 1e-9 * static_cast<double>(stamp_ns - *first_stamp_ns_);
  if (seconds < kBetweenSamples * static_cast<double>(record_.memory.size())) return;
  record_.memory.push_back({seconds, ResidentMib()});
}

void FlightRecorder::SayVergence(const TrackingResult& result, const Atlas& atlas) {
  const Keyframe* reference = atlas.FindKeyframe(atlas.Resolve(result.reference));
  if (reference == nullptr || reference->id.session != session_) return;
  const double vergence = reference->data->vergence;
  if (std::exchange(vergence_, vergence) == vergence) return;
  spdlog::warn("the right camera is turned by {:.3f} degrees ({:.2f} pixels) against its calibration: corrected",
               vergence * 180.0 / std::numbers::pi, vergence * reference->data->camera.focal_x);
}

void FlightRecorder::SayProgress(const Atlas& atlas) {
  if (Clock::now() - latest_progress_ < std::chrono::seconds(10)) return;
  latest_progress_ = Clock::now();
  const std::string total = frame_count_ ? " of " + std::to_string(*frame_count_) : "";
  spdlog::info("{}: frame {}{}, {} tracked, {} keyframes, {} landmarks", name_, record_.frames(), total,
               record_.tracked, atlas.keyframe_count(), atlas.landmark_count());
}

}  // namespace pangaea
