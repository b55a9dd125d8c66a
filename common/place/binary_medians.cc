#include "common/place/binary_medians.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <utility>

#include "common/base/check.h"

namespace pangaea {
namespace {

// Counts, bit by bit, in how many descriptors it is set. Bits are counted eight at a time, as the bytes of a word, and
// carried into whole counters before a byte could overflow.
class BitCounts {
 public:
  void Add(const Descriptor& descriptor) {
    std::array<std::uint8_t, sizeof(Descriptor)> bytes;
    std::memcpy(bytes.data(), &descriptor, sizeof(Descriptor));
    for (std::size_t i = 0; i < bytes.size(); ++i) lanes_[i] += Spread()[bytes[i]];
    ++added_;
    if (++pending_ == std::numeric_limits<std::uint8_t>::max()) Carry();
  }

  // The bits that more than half have.
  Descriptor Majority() {
    Carry();
    Descriptor majority;
    for (std::size_t bit = 0; bit < counts_.size(); ++bit) {
      if (2 * counts_[bit] > added_) majority.words[bit / 64] |= std::uint64_t{1} << (bit % 64);
    }
    return majority;
  }

 private:
  using SpreadTable = std::array<std::uint64_t, 256>;
  // Entry b: a word whose byte i is bit i of b.
  static const SpreadTable& Spread() {
    static const SpreadTable kTable = [] {
      SpreadTable table{};
      for (std::size_t byte = 0; byte < table.size(); ++byte) {
        for (std::size_t bit = 0; bit < 8; ++bit) table[byte] |= std::uint64_t{byte >> bit & 1} << (8 * bit);
      }
      return table;
    }();
    return kTable;
  }

  void Carry() {
    for (std::size_t lane = 0; lane < lanes_.size(); ++lane) {
      for (std::size_t bit = 0; bit < 8; ++bit) counts_[8 * lane + bit] += lanes_[lane] >> (8 * bit) & 0xff;
    }
    lanes_ = {};
    pending_ = 0;
  }

  std::array<std::uint64_t, sizeof(Descriptor)> lanes_{};
  std::array<std::size_t, 8 * sizeof(Descriptor)> counts_{};
  std::size_t added_ = 0;
  unsigned pending_ = 0;
};

// An index below the number of weights, with a probability in proportion to its weight; the weights' sum is not 0.
std::size_t Draw(std::span<const int> weights, std::uint64_t sum, std::mt19937_64& random) {
  // The modulo's bias is below 2^-40 for any real sum; the standard's distributions differ between libraries.
  std::uint64_t rest = random() % sum;
  std::size_t index = 0;
  while (rest >= static_cast<std::uint64_t>(weights[index])) rest -= static_cast<std::uint64_t>(weights[index++]);
  return index;
}

std::vector<Descriptor> DrawCentres(std::span<const Descriptor> descriptors, int count, std::mt19937_64& random) {
  std::vector<Descriptor> centres = {descriptors[random() % descriptors.size()]};
  std::vector<int> distances(descriptors.size(), std::numeric_limits<int>::max());  // to the nearest centre
  while (static_cast<int>(centres.size()) < count) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < descriptors.size(); ++i) {
      distances[i] = std::min(distances[i], HammingDistance(descriptors[i], centres.back()));
      sum += static_cast<std::uint64_t>(distances[i]);
    }
    if (sum == 0) break;  // every descriptor is a centre
    centres.push_back(descriptors[Draw(distances, sum, random)]);
  }
  return centres;
}

std::uint32_t Nearest(const Descriptor& descriptor, std::span<const Descriptor> centres) {
  std::uint32_t nearest = 0;
  int least = std::numeric_limits<int>::max();
  for (std::uint32_t i = 0; i < centres.size(); ++i) {
    const int distance = HammingDistance(descriptor, centres[i]);
    if (distance >= least) continue;
    least = distance;
    nearest = i;
  }
  return nearest;
}

// Did any descriptor change its cluster?
bool Assign(std::span<const Descriptor> descriptors, BinaryClusters& clusters) {
  bool changed = false;
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    const std::uint32_t nearest = Nearest(descriptors[i], clusters.centres);
    changed = changed || nearest != clusters.assignment[i];
    clusters.assignment[i] = nearest;
  }
  return changed;
}

void DropEmptyClusters(BinaryClusters& clusters) {
  std::vector<bool> used(clusters.centres.size(), false);
  for (const std::uint32_t cluster : clusters.assignment) used[cluster] = true;
  std::vector<std::uint32_t> new_index(used.size());
  std::vector<Descriptor> kept;
  for (std::size_t c = 0; c < used.size(); ++c) {
    new_index[c] = static_cast<std::uint32_t>(kept.size());
    if (used[c]) kept.push_back(clusters.centres[c]);
  }
  clusters.centres = std::move(kept);
  for (std::uint32_t& cluster : clusters.assignment) cluster = new_index[cluster];
}

// Each centre becomes the majority of its cluster.
void MoveCentres(std::span<const Descriptor> descriptors, BinaryClusters& clusters) {
  std::vector<BitCounts> counts(clusters.centres.size());
  for (std::size_t i = 0; i < descriptors.size(); ++i) counts[clusters.assignment[i]].Add(descriptors[i]);
  for (std::size_t c = 0; c < counts.size(); ++c) clusters.centres[c] = counts[c].Majority();
}

}  // namespace

BinaryClusters ClusterDescriptors(std::span<const Descriptor> descriptors, const BinaryMediansOptions& options,
                                  std::mt19937_64& random) {
  PANGAEA_CHECK(!descriptors.empty() && options.clusters > 0);
  BinaryClusters clusters;
  clusters.centres = DrawCentres(descriptors, options.clusters, random);
  clusters.assignment.assign(descriptors.size(), 0);
  Assign(descriptors, clusters);
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    DropEmptyClusters(clusters);
    MoveCentres(descriptors, clusters);
    if (!Assign(descriptors, clusters)) break;
  }
  DropEmptyClusters(clusters);
  return clusters;
}

}  // namespace pangaea
