#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "common/map/map_edit.h"

namespace pangaea {

inline constexpr SessionId kSession = 7;
inline constexpr MapId kMap{kSession, 1};

inline KeyframeId Kept(std::uint32_t counter) { return {kSession, counter}; }

// camera_from_map of a camera at (x, 0, 0), not turned.
inline Rigid3d At(double x) { return Rigid3d({1, 0, 0, 0}, {-x, 0, 0}); }

// Adds a keyframe one metre further along x than its parent; without a parent it is the first one of the map, at 0.
inline void Extend(KeyframeId id, KeyframeId parent, Atlas& atlas) {
  auto data = std::make_shared<KeyframeData>();
  data->camera = {640, 480, 400.0, 400.0, 320.0, 240.0, 0.1};
  ASSERT_TRUE(Apply(AddKeyframe{id, kMap, parent, parent.valid() ? At(1.0) : Rigid3d(), data}, atlas));
}

// Keyframes 1, 2, … of kMap.
inline Atlas Chain(std::uint32_t count) {
  Atlas atlas;
  for (std::uint32_t i = 1; i <= count; ++i) Extend(Kept(i), i == 1 ? KeyframeId{} : Kept(i - 1), atlas);
  return atlas;
}

// A correction that moves the map's first keyframe, and multiplies the lengths around it.
inline void Move(KeyframeId root, const Rigid3d& camera_from_map, double scale, Atlas& atlas) {
  ASSERT_TRUE(Apply(MoveKeyframes{{{root, camera_from_map, {}, {}, scale}}, 1}, atlas));
}

}  // namespace pangaea
