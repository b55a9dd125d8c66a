#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/base/result.h"
#include "common/map/atlas.h"
#include "common/wire/map_interest.h"

namespace pangaea {

// How much of its map an agent holds while a server has all of it. Counted in keyframes, those of other sessions
// included: with what they saw, in the agent's atlas and in what it knows of the server's, 0.25 MB each.
struct KeptKeyframesOptions {
  // With more, those far from the camera are forgotten; 0: none are.
  std::size_t most = 120;
  // ... until so many are left. The difference keeps a camera that goes to and fro from forgetting at every keyframe.
  std::size_t left = 100;
  // Forgotten ones that are among so many nearest to the camera are asked back: less than are left, for the same
  // reason.
  std::size_t recalled = 60;
  // The newest of the session are not forgotten, nor are those around the camera by what they see: tracking and mapping
  // are at work on them, and the server gives them back if they are not here.
  std::uint32_t newest = 20;
  std::size_t window = 50;

  // With the others in the same proportions.
  static KeptKeyframesOptions Of(std::size_t most, std::size_t left);
  Status Check() const;
};

// All keyframes, the nearest to the view of `center` first: by how far the camera is from there and how far what it
// looks at is, which counts distances and turns alike, whatever the map's scale. Those of other maps come last.
std::vector<KeyframeId> NearestKeyframes(const Atlas& atlas, const Keyframe& center);

// Those that `atlas`, the agent's, should forget, whose camera is near to `center`. Only what `confirmed` (what the
// server has for certain) has just as well: observations and frames. Empty until there are too many.
std::vector<KeyframeId> ChooseForgotten(const Atlas& atlas, const Atlas& confirmed, KeyframeId center,
                                        SessionId session, const KeptKeyframesOptions& options);

// What the server needs to know to send what is missing here. Something counts as forgotten when both have forgotten
// it: what the server sends of it then comes after what it had sent before.
MapInterest InterestOf(SessionId session, const Atlas& atlas, const Atlas& confirmed, KeyframeId center,
                       const KeptKeyframesOptions& options);

}  // namespace pangaea
