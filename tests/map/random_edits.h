#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "common/map/map_edit.h"

namespace pangaea {

// Edits at random over a small world of two sessions: most can be applied, some refer to what is culled, fused or gone,
// some cannot be applied. What it draws next depends on the atlas, which its caller changes.
class RandomEdits {
 public:
  explicit RandomEdits(std::uint64_t seed) : random_(seed) {}
  MapEdit Next(const Atlas& atlas);
  // From now on also about what lives in this atlas.
  void Adopt(const Atlas& atlas);

 private:
  std::uint32_t Below(std::uint32_t bound) { return static_cast<std::uint32_t>(random_() % bound); }
  double Uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  SessionId AnySession();
  // Of those made so far, alive or not; now and then one that never was.
  KeyframeId AnyKeyframe();
  LandmarkId AnyLandmark();
  MapId AnyMap();
  Rigid3d AnyPose();
  Eigen::Vector3d AnyPoint();

  AddKeyframe MakeKeyframe(const Atlas& atlas);
  AddFramePoses MakeFrames();
  ReferenceScale AnyScale();
  MoveKeyframes MakeMove();
  MergeMaps MakeMerge(const Atlas& atlas);

  std::mt19937_64 random_;
  std::vector<KeyframeId> keyframes_;
  std::vector<LandmarkId> landmarks_;
  std::vector<MapId> maps_;
  std::int64_t stamp_ns_ = 0;
  std::uint64_t corrections_ = 0;
};

}  // namespace pangaea
