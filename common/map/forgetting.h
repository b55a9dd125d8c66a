#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/map/atlas.h"

namespace pangaea {

// A keyframe that is to be forgotten here, or was.
struct ForgottenKeyframe {
  KeyframeId id;
  // The frames it holds, where another atlas of this process holds the same: both share them then. May be nullptr.
  std::shared_ptr<const std::vector<FramePose>> frames = nullptr;
};

// Whether only the keyframe's place is known here, and no more what it saw.
bool IsForgotten(const Keyframe& keyframe);

// Takes from keyframes what they saw: features, observations, and landmarks that nobody else observes. They keep their
// place in map and tree, their pose and their frames, so that whatever moves them moves the trajectory. An AddKeyframe
// of the same id gives them their features back, as long as it brings the same stamp.
// Not an edit: what the map says is the same as before, this copy of it only holds less. It never leaves the process.
// Landmarks that go leave no trace, as if they had never been here, and so do, now and then, the ids around them that
// live no more. Ids that are not alive or forgotten already are left out.
void Forget(Atlas& atlas, std::span<const ForgottenKeyframe> keyframes);

// Where both hold the same frames, they share them from now on: an hour has 72,000 of 96 bytes, and an agent several
// copies of its map. Nothing else changes.
void ShareFrames(Atlas& atlas, const Atlas& twin);

}  // namespace pangaea
