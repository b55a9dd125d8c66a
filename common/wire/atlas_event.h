#pragma once

#include <cstdint>
#include <string>

#include "common/map/ids.h"

namespace pangaea {

// On the wire an integer: other values may come from newer servers.
enum class AtlasEventKind : std::uint32_t {
  kServerStarted = 0,
  kSessionJoined = 1,
  kSessionLost = 2,    // its agent vanished without saying goodbye
  kSessionClosed = 3,  // its agent ended in order
  kNewMap = 4,
  kMapClosed = 5,
  kMerge = 6,
  kLoop = 7,
  kCulled = 8,
  kRejected = 9,
  kStoreFailed = 10,
  kStoreRecovered = 11,
  kWeldRefused = 12,     // a merge or loop that was recognised, but did not hold
  kRelocalized = 13,     // a lost agent's frame was found in the atlas
  kNotRelocalized = 14,  // it was not; the first of those in a row
  kUndone = 15,          // an operator took a merge or loop back
};

struct AtlasEvent {
  std::string site;
  AtlasEventKind kind = AtlasEventKind::kServerStarted;
  std::string text;           // for people
  SessionId session = 0;      // whom it concerns; 0 for nobody in particular
  std::int64_t stamp_ns = 0;  // system clock of the server
  bool operator==(const AtlasEvent&) const = default;
};

}  // namespace pangaea
