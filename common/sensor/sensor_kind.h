#pragma once

namespace pangaea {

// Which images of a dataset or camera are used. Stereo maps are metric, monocular ones have a free scale.
enum class SensorKind { kMonocular, kStereo };

}  // namespace pangaea
