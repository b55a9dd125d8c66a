#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "common/geometry/similarity3.h"
#include "common/map/atlas.h"
#include "server/optimization/correction.h"

namespace pangaea::testing {

struct RingOptions {
  std::uint64_t seed = 1;
  std::uint32_t keyframes = 40;
  std::uint32_t landmarks = 800;
  std::uint32_t views = 10;   // of a landmark, at most
  std::uint32_t spread = 12;  // among so many keyframes around the nearest
  bool stereo = true;
  bool closed = false;    // whether a landmark is seen by keyframes at both ends of the circle
  double noise = 0.0;     // pixels
  double outliers = 0.0;  // part of the observations
};

// One map: keyframes on a circle of 5 m that look outwards at a round wall, each hanging below its predecessor, and the
// corners on the wall. Built from edits; every pose and point is true.
struct Ring {
  Atlas atlas;
  MapId map;
  std::vector<KeyframeId> keyframes;  // in their order on the circle; the first is the root
  std::map<KeyframeId, Rigid3d> camera_from_map;
  std::map<LandmarkId, Eigen::Vector3d> point_in_map;
};
Ring MakeRing(const RingOptions& options);

// The correction that gives these keyframes these cameras (camera_from_map, lengths of the camera), to be applied with
// Rebase: lengths around them become 1 / scale times as long.
Correction PlaceAt(const Atlas& atlas, MapId map, const std::map<KeyframeId, Similarity3d>& cameras);
// The correction that moves keyframes and landmarks at random, the root apart. metres, radians.
Correction Disturb(const Ring& ring, std::uint64_t seed, double translation, double rotation, double of_points);
// The cameras of a ring whose odometry errs by `step_error` from each keyframe to the next.
std::map<KeyframeId, Similarity3d> Drift(const Ring& ring, const Similarity3d& step_error);

// After the correction; fails the test where it cannot be applied.
Atlas Corrected(const Atlas& atlas, const Correction& correction);
// Root mean square distance of the cameras' positions from the true ones, map units.
double PositionError(const Ring& ring, const Atlas& atlas);

}  // namespace pangaea::testing
