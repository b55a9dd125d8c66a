#pragma once

#include <cstdint>
#include <map>
#include <random>
#include <vector>

#include "agent/mapping/keyframe_candidate.h"
#include "common/map/atlas.h"

namespace pangaea::testing {

// A corner on a wall, with the descriptor that a camera sees when nothing disturbs it.
struct WorldPoint {
  Eigen::Vector3d position;
  Descriptor descriptor;
  double size = 0.0;  // octave on which it is found from one metre away
};

struct SyntheticWorldOptions {
  std::uint64_t seed = 1;
  int points = 4000;
  bool stereo = true;
  double pixel_noise = 0.3;       // standard deviation at octave 0, pixels
  double flipped_bits = 0.04;     // part of a descriptor's bits that a view gets wrong
  double missed = 0.1;            // part of the visible points without a keypoint
  double tracked = 0.8;           // part of the recent landmarks in view that tracking follows
  double wrongly_tracked = 0.0;   // part of those that sit on another point's keypoint
  double position_noise = 0.015;  // of the tracked pose, metres
  double rotation_noise = 0.005;  // of the tracked pose, radians
  std::size_t max_keypoints = 1000;
  double vergence = 0.0;  // of the rig, radians: the right camera is turned so far from where its calibration says
};

// A room of 10 x 10 x 4 m with random corners on its walls, floor and ceiling, and a stand-in for tracking that hands
// local mapping the keyframes of a walk through it. The world's origin is the room's centre.
class SyntheticWorld {
 public:
  explicit SyntheticWorld(const SyntheticWorldOptions& options);

  // The next keyframe, seen from camera_from_world and tracked against the previous one and its landmarks.
  KeyframeCandidate NextKeyframe(const Rigid3d& camera_from_world, const Atlas& atlas);
  // Gives all corners another look, but for this share of them.
  void Repaint(double kept);
  // From now on the right camera is turned so far (radians) from where its calibration says.
  void TurnRightCamera(double vergence) { options_.vergence = vergence; }
  // The following keyframe begins this map and has no reference.
  void BeginMap(MapId map);

  const IdealCamera& camera() const { return camera_; }
  const Rigid3d& true_camera_from_world(KeyframeId id) const { return poses_.at(id); }
  // Which corner each keypoint of a keyframe shows.
  const std::vector<int>& points_of(KeyframeId id) const { return points_.at(id); }
  const WorldPoint& point(int index) const { return world_[static_cast<std::size_t>(index)]; }

 private:
  struct View {
    std::shared_ptr<KeyframeData> data;
    std::vector<int> points;
  };
  View Look(const Rigid3d& camera_from_world);
  Keypoint MakeKeypoint(const Eigen::Vector3d& point_in_camera, int octave);
  Descriptor Disturb(Descriptor descriptor);
  std::map<int, LandmarkId> RecentLandmarks(const Atlas& atlas) const;
  std::vector<LandmarkId> Follow(const View& view, const Atlas& atlas);
  double Uniform() { return std::uniform_real_distribution<double>()(random_); }
  double Normal() { return std::normal_distribution<double>()(random_); }

  SyntheticWorldOptions options_;
  std::mt19937_64 random_;
  IdealCamera camera_;
  std::vector<WorldPoint> world_;
  std::map<KeyframeId, Rigid3d> poses_;
  std::map<KeyframeId, std::vector<int>> points_;
  std::vector<KeyframeId> recent_;  // of the current map, oldest first
  MapId map_{1, 1};
  std::uint32_t keyframes_ = 0;
};

// A camera at `position`, upright, looking along `yaw` (radians from +x towards +y; +z is up in the world).
Rigid3d LookAlong(const Eigen::Vector3d& position, double yaw);
// Pose k of n on a closed circle of radius 1.5 m, looking ahead and outwards.
Rigid3d CirclePose(int k, int n);

}  // namespace pangaea::testing
