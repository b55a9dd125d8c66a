#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/map/edits/edits.h"

namespace pangaea {

// About as many octets of edits go into an envelope: the size at which DDS is fastest.
inline constexpr std::size_t kEnvelopeBytes = 200'000;

// Splits edits, in order, into runs of about `max_bytes` octets when encoded; an edit that is larger makes a run of
// its own.
std::vector<std::span<const MapEdit>> PackEdits(std::span<const MapEdit> edits, std::size_t max_bytes);

}  // namespace pangaea
