#pragma once

#include <array>
#include <cstdint>

namespace pangaea {

// One bit of a descriptor: is the (smoothed) pixel a darker than the pixel b? Offsets from the keypoint, pixels of its
// octave, for a patch of orientation 0.
struct BriefTest {
  std::int8_t ax = 0;
  std::int8_t ay = 0;
  std::int8_t bx = 0;
  std::int8_t by = 0;
};

// No offset is longer than this, so that a patch of this radius holds the tests at every orientation.
inline constexpr int kBriefRadius = 15;

// The tests of the 256 bits. Part of the wire format: another table would make stored descriptors meaningless.
extern const std::array<BriefTest, 256> kBriefTests;

}  // namespace pangaea
