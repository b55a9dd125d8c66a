#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/base/result.h"
#include "common/map/ids.h"
#include "common/map/map_piece.h"

namespace pangaea {

// What the server tells one agent of its atlas: absolute state, so that a newer one replaces what an older one said.
struct AgentCorrection {
  SessionId session = 0;
  std::uint64_t server_incarnation = 0;
  // Grows with each correction of a session, also over restarts of the server: 1024 times the position of its journal,
  // and a count of those that were cut there.
  std::uint64_t version = 0;
  // The state the pieces were cut from holds the session's envelopes up to this sequence and none after it.
  std::uint64_t acknowledged = 0;
  std::vector<MapPiece> pieces;  // one for each map
  // It lists all that the session's keyframes observe, as far as the agent has not forgotten it, and holds against what
  // the agent says: the answer to a claim that was wrong.
  bool complete = false;
};

// A part of an encoded correction: messages on DDS stay small.
struct CorrectionPart {
  SessionId session = 0;
  std::uint64_t server_incarnation = 0;
  std::uint64_t version = 0;
  std::uint64_t acknowledged = 0;
  std::uint32_t part = 0;  // 0 to parts - 1, sent in this order
  std::uint32_t parts = 0;
  std::uint64_t checksum = 0;  // Hash64 of the octets of all parts together
  std::vector<std::byte> octets;
  bool complete = false;
  bool operator==(const CorrectionPart&) const = default;
};

// At which size DDS is fastest, and how large a correction may be altogether.
inline constexpr std::size_t kCorrectionPartBytes = 200'000;
inline constexpr std::size_t kMaxCorrectionPartBytes = 1U << 20U;
inline constexpr std::size_t kMaxCorrectionBytes = 64U << 20U;

std::vector<CorrectionPart> SplitCorrection(const AgentCorrection& correction,
                                            std::size_t part_bytes = kCorrectionPartBytes);

// Puts the parts of one session's corrections together. Parts of a newer correction displace those of an older one.
class CorrectionAssembly {
 public:
  // The correction, once its last part is here; nothing before, and nothing for parts that do not follow what came
  // (older, repeated, of a correction whose beginning was lost). An error for octets that are none of ours.
  Result<std::optional<AgentCorrection>> Take(CorrectionPart part);

 private:
  Result<std::optional<AgentCorrection>> Finish();

  std::optional<CorrectionPart> gathered_;  // the first part, with the octets of all so far
  std::uint32_t next_ = 0;
};

}  // namespace pangaea
