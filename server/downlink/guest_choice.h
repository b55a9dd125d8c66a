#pragma once

#include <cstddef>
#include <vector>

#include "common/base/result.h"
#include "common/map/atlas.h"

namespace pangaea {

struct GuestOptions {
  // Keyframes of other sessions around its camera that an agent is given: with its own local map about what tracking
  // looks at.
  std::size_t wanted = 30;
  // Of these, how many that it does not hold yet one correction brings: their features are 45 kB each.
  std::size_t new_at_once = 8;
  // The same where the agent was lost and was found again: it looks at all of the place at once.
  std::size_t found_at_once = 16;
  // The window grows over so many keyframes of all sessions to find them.
  std::size_t window = 120;

  Status Check() const;
};

// The keyframes of other sessions nearest to the keyframe that an agent's camera is near to, by what they see in
// common: the nearest first. None where it is not in the atlas.
std::vector<KeyframeId> ChooseGuests(const Atlas& atlas, KeyframeId near, SessionId session,
                                     const GuestOptions& options);

}  // namespace pangaea
