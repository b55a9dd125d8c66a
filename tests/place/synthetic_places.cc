#include "tests/place/synthetic_places.h"

#include "common/base/check.h"
#include "common/place/vocabulary_training.h"

namespace pangaea::testing {

Descriptor RandomDescriptor(Random& random) { return {{random(), random(), random(), random()}}; }

Descriptor SeenAgain(const Descriptor& descriptor, int bits, Random& random) {
  Descriptor again = descriptor;
  for (int i = 0; i < bits; ++i) {
    const std::uint64_t bit = random() % 256;
    again.words[bit / 64] ^= std::uint64_t{1} << (bit % 64);
  }
  return again;
}

SyntheticPlaces::SyntheticPlaces(std::size_t places, std::size_t corners_each, Random& random) : corners(places) {
  for (auto& place : corners) {
    for (std::size_t i = 0; i < corners_each; ++i) place.push_back(RandomDescriptor(random));
  }
}

std::vector<Descriptor> SyntheticPlaces::Image(std::size_t place, double share, Random& random) const {
  // Random descriptors have no clusters for a vocabulary to find, so that words are brittle: little noise.
  constexpr int kNoiseBits = 4;
  std::vector<Descriptor> image;
  for (const Descriptor& corner : corners[place]) {
    const bool shown = static_cast<double>(random() % 1000) < 1000.0 * share;
    image.push_back(shown ? SeenAgain(corner, kNoiseBits, random) : RandomDescriptor(random));
  }
  return image;
}

VocabularyTree SmallVocabulary(std::uint64_t seed, int branching, int depth) {
  Random random(seed);
  const SyntheticPlaces places(20, 200, random);
  std::vector<std::vector<Descriptor>> images;
  for (std::size_t place = 0; place < places.corners.size(); ++place)
    images.push_back(places.Image(place, 1.0, random));
  auto tree = TrainVocabulary(images, {.branching = branching, .depth = depth, .seed = seed});
  PANGAEA_CHECK(tree.has_value());
  return std::move(*tree);
}

}  // namespace pangaea::testing
