#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "agent/mapping/local_mapper.h"
#include "agent/tracking/tracker.h"
#include "common/geometry/stamped_pose.h"
#include "common/simulation/image_sensor.h"
#include "common/simulation/renderer.h"

namespace pangaea::testing {

// A wall seen from below in y: x to the right, z upwards, at `y` (metres). It looks like a concrete wall of that size,
// magnified `magnification` times. Different seeds give different pictures.
Surface MakeWall(double from_x, double to_x, double y, double half_height, std::uint64_t seed,
                 double magnification = 1.0);

// The pose (world_from_camera) of an upright camera at (x, 0, 0) that looks along +y.
Rigid3d LookingAtTheWalls(double x);

// A stereo camera that goes through a scene of walls, drawn frame by frame at 20 Hz, and tracked and mapped in order on
// one thread, as the agent does with --deterministic.
class RenderedFlight {
 public:
  RenderedFlight(std::vector<Surface> surfaces, const TrackingOptions& options, SessionId session = 1,
                 std::uint64_t seed = 1);

  // One frame from there; in the dark the picture shows the sensor's noise alone.
  TrackingResult Fly(const Rigid3d& world_from_camera);
  TrackingResult FlyInTheDark();
  // Frames from `from` to `to` (x, metres) with `step` metres between them; their results.
  std::vector<TrackingResult> FlyAlong(double from, double to, double step);

  // Ends it: the last frame becomes a keyframe, where it was tracked and is none. Returns which.
  std::optional<KeyframeId> Land();

  // Tracking sees what mapping does so many frames late, as where mapping has a thread of its own.
  void LetMappingLag(int frames) { lag_ = frames; }
  void Suggest(const PlaceHint& hint) { tracker_.Suggest(hint); }
  // What a server says that had been told everything.
  void Absorb(const AgentCorrection& correction);

  const Atlas& atlas() const { return mapper_.atlas(); }
  // The tracked frames of each map by the latest knowledge.
  std::map<MapId, std::vector<StampedPose>> Trajectories() const;
  const std::vector<StampedPose>& truth() const { return truth_; }
  // Root of the mean squared distance to the truth over all maps, each aligned by itself, metres.
  double PositionError() const;

 private:
  TrackingResult Track(const cv::Mat& left, const RightImage& right);
  cv::Mat Draw(const Rigid3d& world_from_camera);

  SessionId session_;
  std::vector<Surface> surfaces_;
  IdealCamera camera_;
  Renderer renderer_;
  ImageSensor sensor_;
  Tracker tracker_;
  KeyframeBuilder builder_;
  LocalMapper mapper_;
  std::shared_ptr<const Atlas> snapshot_;
  int lag_ = 0;
  std::optional<int> frames_until_seen_;  // until the snapshot is renewed; none: it is
  std::int64_t stamp_ns_ = 0;
  std::uint64_t pictures_ = 0;
  std::vector<StampedPose> truth_;
};

}  // namespace pangaea::testing
