#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/map/atlas.h"
#include "common/map/map_edit.h"

namespace pangaea {

// Ids of the two sessions that the small worlds have.
inline constexpr SessionId kAnna = 0xa;
inline constexpr SessionId kBert = 0xb;

inline KeyframeId K(std::uint32_t counter, SessionId session = kAnna) { return {session, counter}; }
inline LandmarkId L(std::uint32_t counter, SessionId session = kAnna) { return {session, counter}; }
inline MapId M(std::uint32_t counter, SessionId session = kAnna) { return {session, counter}; }

// What a camera of 752 x 480 pixels saw: `keypoints` keypoints, every other one with depth.
std::shared_ptr<const KeyframeData> MakeData(std::size_t keypoints, std::int64_t stamp_ns = 0);
// A turn about some axis and this translation.
Rigid3d MakePose(double angle, double x, double y, double z);

// An atlas under test, and the edits that a test writes most.
class SmallWorld {
 public:
  Atlas atlas;

  // Fails the test where the edit is refused or leaves the atlas inconsistent.
  void Do(const MapEdit& edit);
  // Fails the test where the edit is taken, fails with another code, or changes anything.
  void Refuse(const MapEdit& edit, ErrorCode code);

  void Root(KeyframeId id, MapId map, std::size_t keypoints = 20);
  // Half a metre beside its parent.
  void Child(KeyframeId id, KeyframeId parent, MapId map, std::size_t keypoints = 20);
  // Four metres in front of the reference camera.
  void Add(LandmarkId id, KeyframeId reference, std::uint32_t keypoint);
  void Observe(LandmarkId id, KeyframeId keyframe, std::uint32_t keypoint);

  const Keyframe& Get(KeyframeId id) const;
  const Landmark& Get(LandmarkId id) const;
};

// Keyframes 1 - 2 - 3 in a row under root 1 in map 1 of Anna; landmarks 1 (seen from 1 and 2), 2 (from 2 and 3) and 3
// (from 3 alone), each at the keypoint of its number.
SmallWorld RowOfThree();

// All that an atlas is made of, bit by bit.
std::vector<std::byte> Fingerprint(const Atlas& atlas);
bool SameBits(const Rigid3d& a, const Rigid3d& b);

}  // namespace pangaea
