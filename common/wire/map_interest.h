#pragma once

#include <cstdint>
#include <vector>

#include "common/map/ids.h"

namespace pangaea {

// What an agent believes that it and the server have in common.
struct DigestClaim {
  std::uint64_t number = 0;    // of the session's claims, from 1; 0: it claims nothing
  std::uint64_t sequence = 0;  // of the newest envelope that the digest counts in
  std::uint64_t digest = 0;    // DigestOfSession, of its own atlas
  bool operator==(const DigestClaim&) const = default;
};

// Where an agent is and what it holds of others, so that the server can send it what it lacks.
struct MapInterest {
  SessionId session = 0;
  std::uint64_t applied_version = 0;  // of the newest correction it applied; 0 before any
  MapId map;                          // the agent's name of the map it is in; none while it has none
  KeyframeId reference;               // the keyframe its camera is near to; none while it has none
  std::vector<KeyframeId> guests;     // keyframes of other sessions that it holds, ascending
  // Those of its own session of which it holds what they saw, ascending; the others it has forgotten, except those with
  // higher counters, which are newer than this. Empty: all of them.
  std::vector<KeyframeId> held = {};
  std::vector<KeyframeId> wanted = {};  // what it has forgotten and wants back, nearest to its camera first
  DigestClaim claim = {};
  bool operator==(const MapInterest&) const = default;
};

}  // namespace pangaea
