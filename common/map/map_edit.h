#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "common/base/bytes.h"
#include "common/base/result.h"
#include "common/map/atlas.h"
#include "common/map/edits/edits.h"

namespace pangaea {

// Whether the edit can be applied. kInvalidArgument: a number or size out of range; kNotFound: it refers to an id that
// was never here; kRefused: it contradicts what is here (duplicate id, keypoint in use, ...).
Status Validate(const MapEdit& edit, const Atlas& atlas);
// Validates, then changes the atlas; after an error nothing is changed. The same edits in the same order give the same
// bits everywhere.
Status Apply(const MapEdit& edit, Atlas& atlas);

// One edit by itself: tag, version, body.
void Encode(const MapEdit& edit, ByteWriter& writer);
Result<MapEdit> Decode(ByteReader& reader);  // kCorrupt, or kUnsupported for an unknown tag or version
// Many edits, which share one table of sessions: the payload of an envelope. Any bytes give an error or edits that
// encode to what they mean.
std::vector<std::byte> EncodeEdits(std::span<const MapEdit> edits);
Result<std::vector<MapEdit>> DecodeEdits(std::span<const std::byte> bytes);

std::string_view KindName(const MapEdit& edit);
// Whether all that the edit creates, changes or removes belongs to the session. Others' things may be what it refers
// to: a parent, the landmark one of its keyframes observes, the landmark one of its own is fused into.
bool TouchesOnly(const MapEdit& edit, SessionId session);

}  // namespace pangaea
