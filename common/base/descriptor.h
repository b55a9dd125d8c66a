#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace pangaea {

// A 256-bit binary descriptor (rotated BRIEF).
struct Descriptor {
  std::array<std::uint64_t, 4> words{};
  bool operator==(const Descriptor&) const = default;
};

// Number of differing bits, 0 to 256.
inline int HammingDistance(const Descriptor& a, const Descriptor& b) {
  int distance = 0;
  for (std::size_t i = 0; i < a.words.size(); ++i) distance += std::popcount(a.words[i] ^ b.words[i]);
  return distance;
}

}  // namespace pangaea
