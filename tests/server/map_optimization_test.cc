#include "server/atlas/map_optimization.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/map/consistency.h"
#include "tests/map/random_edits.h"
#include "tests/map/small_world.h"
#include "tests/server/fusion_world.h"

namespace pangaea::testing {
namespace {

using ::testing::IsEmpty;

const MapId kMap{kOlder, 1};

// Welded at one end of their way by a small window.
WeldedFlights WeldedAtOneEnd(std::uint64_t seed) {
  FusionOptions options;
  options.window.keyframes = 5;
  return {seed, CirclePoses(0, 16, 40), 2, options};
}

void Carry(const OptimizedMap& optimized, Atlas& atlas) {
  ServerDraft draft(atlas, 9);
  const Status made = OptimizationEdits(optimized, draft);
  ASSERT_TRUE(made.has_value()) << made.error().message;
  for (const MapEdit& edit : draft.edits()) ASSERT_TRUE(Apply(edit, atlas).has_value()) << KindName(edit);
  EXPECT_EQ(Fingerprint(atlas), Fingerprint(draft.atlas()));
}

class OptimizeMapTest : public ::testing::TestWithParam<std::uint64_t> {};
INSTANTIATE_TEST_SUITE_P(Seeds, OptimizeMapTest, ::testing::Range<std::uint64_t>(1, 4));

TEST_P(OptimizeMapTest, AWeldedMapIsAdjustedAndRidOfDuplicates) {
  const WeldedFlights welded = WeldedAtOneEnd(GetParam());
  const auto optimized = OptimizeMap(welded.merged, kMap, {}, {}, {});
  ASSERT_TRUE(optimized.has_value());
  Atlas atlas = welded.merged;
  Carry(optimized->optimized, atlas);
  EXPECT_THAT(CheckConsistency(atlas), IsEmpty());
  EXPECT_LT(CountDuplicates(welded.world, atlas), CountDuplicates(welded.world, welded.merged) / 10);
  EXPECT_LT(WorstError(welded.world, atlas, AllKeyframes(welded.world)), 0.02);
}

TEST_P(OptimizeMapTest, OnceAdjustedWhatDidNotFitBeforeBecomesOneAsWell) {
  const WeldedFlights welded = WeldedAtOneEnd(GetParam());
  Atlas atlas = welded.merged;
  for (int i = 0; i < 2; ++i) {
    const auto optimized = OptimizeMap(atlas, kMap, {}, {}, {});
    ASSERT_TRUE(optimized.has_value());
    Carry(optimized->optimized, atlas);
  }
  EXPECT_LT(CountDuplicates(welded.world, atlas), CountDuplicates(welded.world, welded.merged) / 20);
  EXPECT_LE(CountMixed(welded.world, atlas), 1U);
}

TEST_P(OptimizeMapTest, OnAnAtlasThatMovedOnItLeavesItConsistent) {
  const WeldedFlights welded = WeldedAtOneEnd(GetParam());
  const auto optimized = OptimizeMap(welded.merged, kMap, {}, {}, {});
  ASSERT_TRUE(optimized.has_value());
  Atlas atlas = welded.merged;
  RandomEdits random(GetParam());
  random.Adopt(atlas);
  for (int i = 0; i < 100; ++i) (void)Apply(random.Next(atlas), atlas);
  Carry(optimized->optimized, atlas);
  EXPECT_THAT(CheckConsistency(atlas), IsEmpty());
}

TEST(OptimizeOneMap, AStopGivesNothing) {
  const WeldedFlights welded = WeldedAtOneEnd(1);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(OptimizeMap(welded.merged, kMap, {}, {}, stop.get_token()).has_value());
}

}  // namespace
}  // namespace pangaea::testing
