#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/map/ids.h"

namespace pangaea {

// The numbered unit of the uplink: identical bytes on DDS and in the server's journal.
struct Envelope {
  SessionId session = 0;
  std::uint64_t sequence = 0;  // 1, 2, 3 … without gaps within a session
  std::uint64_t base_correction_version = 0;  // the newest correction the sender had applied; 0 before any
  std::uint32_t wire_version = 0;
  std::uint64_t checksum = 0;  // Hash64 of `edits`
  std::vector<std::byte> edits;  // EncodeEdits()
};

}  // namespace pangaea
