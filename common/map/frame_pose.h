#pragma once

#include <cstddef>

#include "common/map/keyframe.h"
#include "common/map/map_bytes.h"

namespace pangaea {

// Stamp and motion (not the session): 24 bytes and the stamp for what QuantizeFramePose gave, exact in any case.
inline constexpr std::size_t kMinFramePoseBytes = 26;
void WriteFramePose(const FramePose& pose, MapWriter& writer);
FramePose ReadFramePose(MapReader& reader);

}  // namespace pangaea
