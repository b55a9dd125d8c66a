#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/map/consistency.h"
#include "tests/map/random_edits.h"
#include "tests/map/small_world.h"
#include "tests/server/fusion_world.h"

namespace pangaea::testing {
namespace {

using ::testing::IsEmpty;

// What agents and the server's other jobs may have done to the atlas between the snapshot and the weld.
void MoveOn(int edits, std::uint64_t seed, Atlas& atlas) {
  RandomEdits random(seed);
  random.Adopt(atlas);
  for (int i = 0; i < edits; ++i) (void)Apply(random.Next(atlas), atlas);
}

class Interleaving : public ::testing::TestWithParam<std::uint64_t> {};
INSTANTIATE_TEST_SUITE_P(Seeds, Interleaving, ::testing::Range<std::uint64_t>(1, 11));

TEST_P(Interleaving, APlanOnAnAtlasThatMovedOnLeavesItConsistent) {
  const std::uint64_t seed = GetParam();
  const SurveyedWorld world = TwoMaps(1 + seed % 4);
  const WeldingOutcome plan = PlanWelding(world.atlas, MiddleMatch(world), {}, {});
  ASSERT_TRUE(plan.has_value()) << Describe(plan.error());
  Atlas atlas = world.atlas;
  MoveOn(static_cast<int>(10 * seed), seed, atlas);
  ASSERT_THAT(CheckConsistency(atlas), IsEmpty());
  Carry(*plan, atlas);
  EXPECT_THAT(CheckConsistency(atlas), IsEmpty());
}

TEST_P(Interleaving, WhatWasAppliedGivesTheSameAtlasWhenItIsReplayed) {
  const std::uint64_t seed = GetParam();
  const SurveyedWorld world = TwoMaps(1 + seed % 4);
  const WeldingOutcome plan = PlanWelding(world.atlas, MiddleMatch(world), {}, {});
  ASSERT_TRUE(plan.has_value()) << Describe(plan.error());
  Atlas atlas = world.atlas;
  MoveOn(static_cast<int>(10 * seed), seed, atlas);
  Atlas replayed = atlas;
  const std::vector<MapEdit> journal = ApplyTolerantly(plan->edits, atlas);
  for (const MapEdit& edit : journal) ASSERT_TRUE(Apply(edit, replayed).has_value()) << KindName(edit);
  EXPECT_EQ(Fingerprint(replayed), Fingerprint(atlas));
}

TEST(LateWeld, AMapThatWasMergedElsewhereMeanwhileIsLeftAlone) {
  const SurveyedWorld world = TwoMaps(2);
  const WeldingOutcome plan = PlanWelding(world.atlas, MiddleMatch(world), {}, {});
  ASSERT_TRUE(plan.has_value());
  Atlas atlas = world.atlas;
  Carry(*plan, atlas);
  const std::uint64_t version = atlas.version();
  EXPECT_THAT(ApplyTolerantly(plan->edits, atlas), IsEmpty());
  EXPECT_EQ(atlas.version(), version);
}

}  // namespace
}  // namespace pangaea::testing
