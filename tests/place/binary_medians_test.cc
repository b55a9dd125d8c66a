#include "common/place/binary_medians.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/place/synthetic_places.h"

namespace pangaea {
namespace {

using testing::Random;
using testing::RandomDescriptor;
using testing::SeenAgain;

TEST(BinaryMedians, RecoverPlantedClusters) {
  constexpr std::size_t kPlanted = 8;
  std::ptrdiff_t recovered = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    std::vector<Descriptor> planted, descriptors;
    for (std::size_t i = 0; i < kPlanted; ++i) planted.push_back(RandomDescriptor(random));
    for (std::size_t i = 0; i < 100 * kPlanted; ++i) {
      descriptors.push_back(SeenAgain(planted[i % kPlanted], 3, random));
    }
    const BinaryClusters clusters = ClusterDescriptors(descriptors, {.clusters = kPlanted}, random);
    ASSERT_EQ(clusters.centres.size(), kPlanted);
    // The majority of 100 noisy copies is the planted centre itself.
    for (const Descriptor& centre : planted) recovered += std::ranges::count(clusters.centres, centre);
  }
  // Two first centres in one planted cluster leave another without: of 80 a few.
  EXPECT_GE(recovered, 60);
}

TEST(BinaryMedians, TheCentreOfOneClusterHasTheBitsOfMost) {
  Random random(3);
  const Descriptor often = RandomDescriptor(random), rare = RandomDescriptor(random);
  // More than 255 of a kind: whole counters take over from the bytes.
  std::vector<Descriptor> descriptors(700, often);
  descriptors.insert(descriptors.end(), 600, rare);
  EXPECT_EQ(ClusterDescriptors(descriptors, {.clusters = 1}, random).centres, std::vector{often});
}

TEST(BinaryMedians, FewerDifferentDescriptorsThanClustersGiveOneEach) {
  Random random(1);
  const Descriptor a = RandomDescriptor(random), b = RandomDescriptor(random), c = RandomDescriptor(random);
  const std::vector<Descriptor> descriptors = {a, b, a, c, c, a};
  const BinaryClusters clusters = ClusterDescriptors(descriptors, {.clusters = 10}, random);
  ASSERT_EQ(clusters.centres.size(), 3U);
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    EXPECT_EQ(clusters.centres[clusters.assignment[i]], descriptors[i]);
  }
}

TEST(BinaryMedians, EveryDescriptorBelongsToItsNearestCentreAndNoClusterIsEmpty) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    std::vector<Descriptor> descriptors;
    for (int i = 0; i < 60; ++i) descriptors.push_back(SeenAgain(Descriptor{}, 6, random));
    const BinaryClusters clusters = ClusterDescriptors(descriptors, {.clusters = 12}, random);
    EXPECT_EQ(std::set(clusters.assignment.begin(), clusters.assignment.end()).size(), clusters.centres.size());
    for (std::size_t i = 0; i < descriptors.size(); ++i) {
      const int own = HammingDistance(descriptors[i], clusters.centres[clusters.assignment[i]]);
      for (const Descriptor& centre : clusters.centres) EXPECT_LE(own, HammingDistance(descriptors[i], centre));
    }
  }
}

}  // namespace
}  // namespace pangaea
