#pragma once

#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "common/base/result.h"
#include "common/map/atlas.h"
#include "common/map/edits/edits.h"
#include "common/wire/edit_ack.h"
#include "common/wire/envelope.h"

namespace pangaea {

// Why an envelope is refused as a whole.
struct Refusal {
  RejectionReason reason = RejectionReason::kUnspecified;
  std::string text;
};

// The edits of an envelope that may stand in the journal as far as that can be told without the atlas: wire version,
// size, checksum, decoding, and that the session sends only what it owns.
tl::expected<std::vector<MapEdit>, Refusal> JudgeContent(const Envelope& envelope);

// Apply, or ApplyAgentEdit.
using ApplyOne = Status (*)(const MapEdit& edit, Atlas& atlas);
// Applies all edits, or none of them: the atlas as it would be, or what is wrong with the first edit that does not fit.
tl::expected<Atlas, Refusal> ApplyWhole(const std::vector<MapEdit>& edits, const Atlas& atlas, ApplyOne apply);

}  // namespace pangaea
