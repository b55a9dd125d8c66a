#pragma once

#include <cstddef>
#include <cstdint>

namespace pangaea {

// What an edit may hold. Wider than anything real, narrow enough that no message can make the atlas blow up.
inline constexpr std::size_t kMaxKeypoints = 65535;
inline constexpr int kMaxImageSide = 16384;  // pixels
// Counters index chunk tables: at these bounds a table's directory stays below 300 KB.
inline constexpr std::uint32_t kMaxKeyframeCounter = 1U << 24;
inline constexpr std::uint32_t kMaxLandmarkCounter = 1U << 26;
inline constexpr std::uint32_t kMaxMapCounter = 1U << 20;
inline constexpr double kMaxLength = 1e6;       // metres (or units of a scale-free map): of relative poses and points
inline constexpr double kMaxVergence = 0.1;     // radians, either way: a rig bent by more would find no matches
inline constexpr double kMaxScale = 1e4;        // of a similarity, and its inverse
inline constexpr double kMaxTotalScale = 1e12;  // of a keyframe, after many corrections, and its inverse
// Bound of absolute coordinates after a merge, which may multiply lengths again and again.
inline constexpr double kMaxCoordinate = 1e12;

}  // namespace pangaea
