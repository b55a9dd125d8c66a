#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/map/edits/edits.h"
#include "common/map/ids.h"

namespace pangaea {

// The version of envelopes and of the octets in them that this build writes. Versions from kOldestWireVersion on are
// read for ever: they stand in journals.
inline constexpr std::uint32_t kWireVersion = 1;
inline constexpr std::uint32_t kOldestWireVersion = 1;

// An agent splits its edits at about 200 KB, the size at which DDS is fastest; one edit that is larger travels alone.
// What is beyond this limit was not made by an agent.
inline constexpr std::size_t kMaxEnvelopeBytes = 4U << 20U;

// The numbered unit of the uplink: identical bytes on DDS and in the server's journal.
struct Envelope {
  SessionId session = 0;
  std::uint64_t sequence = 0;                 // 1, 2, 3 … without gaps within a session
  std::uint64_t base_correction_version = 0;  // the newest correction the sender had applied; 0 before any
  std::uint32_t wire_version = 0;
  std::uint64_t checksum = 0;    // Hash64 of `edits`
  std::vector<std::byte> edits;  // EncodeEdits()
  bool operator==(const Envelope&) const = default;
};

// An envelope of this build's wire version around the encoded edits.
Envelope MakeEnvelope(SessionId session, std::uint64_t sequence, std::uint64_t base_correction_version,
                      std::span<const MapEdit> edits);

// Whether an envelope from outside may be decoded: session and sequence are not 0 (kInvalidArgument), the wire version
// is known (kUnsupported), the size is within the limit (kInvalidArgument), the checksum fits (kCorrupt).
Status CheckEnvelope(const Envelope& envelope);

}  // namespace pangaea
