#include "common/map/id_set.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "common/map/limits.h"

namespace pangaea {
namespace {

TEST(IdSet, HoldsWhatASetHoldsInTheSameOrder) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    const std::uint32_t range = seed % 2 == 0 ? 300 : 100'000;
    std::set<LandmarkId> expected;
    LandmarkIdSet ids;
    for (int i = 0; i < 2000; ++i) {
      const LandmarkId id{1 + random() % 3, static_cast<std::uint32_t>(1 + random() % range)};
      EXPECT_EQ(ids.Insert(id), expected.insert(id).second);
    }
    EXPECT_EQ(ids.size(), expected.size());
    EXPECT_EQ(ids.Ascending(), std::vector<LandmarkId>(expected.begin(), expected.end()));
    for (int i = 0; i < 2000; ++i) {
      const LandmarkId id{random() % 5, static_cast<std::uint32_t>(random() % (2 * range))};
      EXPECT_EQ(ids.Contains(id), expected.contains(id));
    }
  }
}

TEST(IdSet, TakesTheLargestCounterThereMayBe) {
  LandmarkIdSet ids;
  EXPECT_TRUE(ids.Insert({7, kMaxLandmarkCounter}));
  EXPECT_FALSE(ids.Insert({7, kMaxLandmarkCounter}));
  EXPECT_TRUE(ids.Contains({7, kMaxLandmarkCounter}));
  EXPECT_EQ(ids.Ascending(), (std::vector<LandmarkId>{{7, kMaxLandmarkCounter}}));
}

}  // namespace
}  // namespace pangaea
