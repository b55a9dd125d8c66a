#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "common/base/descriptor.h"
#include "common/place/vocabulary_tree.h"

namespace pangaea::testing {

using Random = std::mt19937_64;

Descriptor RandomDescriptor(Random& random);
// The same corner seen again: `bits` random bits are flipped (some perhaps back).
Descriptor SeenAgain(const Descriptor& descriptor, int bits, Random& random);

// A world of places with corners of their own, and images of them.
struct SyntheticPlaces {
  std::vector<std::vector<Descriptor>> corners;  // by place

  SyntheticPlaces(std::size_t places, std::size_t corners_each, Random& random);
  // Shows `share` of the place's corners, each a little different, and as many unrelated ones as are missing.
  std::vector<Descriptor> Image(std::size_t place, double share, Random& random) const;
};

// Trained on a few images of unrelated places.
VocabularyTree SmallVocabulary(std::uint64_t seed = 1, int branching = 8, int depth = 3);

}  // namespace pangaea::testing
