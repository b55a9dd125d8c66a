#pragma once

#include <cstdint>

namespace pangaea {

// Which images of a dataset or camera are used. Stereo maps are metric, monocular ones have a free scale. On the wire
// an integer: a kind this build does not know arrives as it is.
enum class SensorKind : std::uint32_t { kMonocular = 0, kStereo = 1 };

}  // namespace pangaea
