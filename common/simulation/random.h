#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace pangaea {

// Mixes two words into a well spread third (the finaliser of SplitMix64, Steele et al. 2014): seeds of parts are
// derived from the seed of the whole, so that parts can be made in any order and on any thread.
inline std::uint64_t MixSeed(std::uint64_t seed, std::uint64_t part) {
  std::uint64_t z = seed + 0x9e3779b97f4a7c15ULL * (part + 1);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

// A small generator with its own distributions: those of the standard library differ between implementations. So does
// the order in which compilers evaluate the arguments of a call and the operands of an operator: several draws stand in
// statements of their own, or in braces, which are ordered.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t Next() { return MixSeed(state_++, 0x51ed27); }
  // In [0, 1).
  double Unit() { return static_cast<double>(Next() >> 11) * 0x1.0p-53; }
  double Uniform(double low, double high) { return low + (high - low) * Unit(); }
  // In [0, count); count > 0.
  int Index(int count) { return static_cast<int>(Next() % static_cast<std::uint64_t>(count)); }
  bool Chance(double probability) { return Unit() < probability; }
  // Standard normal (Box and Muller 1958).
  double Gaussian() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - Unit()));
    return radius * std::cos(2.0 * std::numbers::pi * Unit());
  }

 private:
  std::uint64_t state_;
};

}  // namespace pangaea
