#include "server/atlas/map_economy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/map/consistency.h"
#include "server/atlas/economy_agenda.h"
#include "tests/map/small_world.h"
#include "tests/server/fusion_world.h"

namespace pangaea::testing {
namespace {

using ::testing::IsEmpty;

const MapId kMap{kOlder, 1};

// With many more keyframes than the way needs, welded in the middle.
WeldedFlights FlownTwice(std::uint64_t seed) { return {seed, CirclePoses(0, 19, 80), 10}; }

Atlas Economized(const Atlas& atlas, const MapEconomy& economy) {
  Atlas after = atlas;
  ServerDraft draft(atlas, 9);
  EXPECT_TRUE(OptimizationEdits(economy.changes, draft).has_value());
  for (const MapEdit& edit : draft.edits()) EXPECT_TRUE(Apply(edit, after).has_value()) << KindName(edit);
  EXPECT_THAT(CheckConsistency(after), IsEmpty());
  return after;
}

class Economy : public ::testing::TestWithParam<std::uint64_t> {};
INSTANTIATE_TEST_SUITE_P(Seeds, Economy, ::testing::Range<std::uint64_t>(1, 4));

TEST_P(Economy, OfAPlaceMappedTwiceMuchLessThanTwoMapsRemains) {
  const WeldedFlights flown = FlownTwice(GetParam());
  const auto economy = EconomizeMap(flown.merged, kMap, {}, {}, {}, {}, {});
  ASSERT_TRUE(economy.has_value());
  const Atlas after = Economized(flown.merged, *economy);
  EXPECT_LT(after.keyframe_count(), flown.world.atlas.keyframe_count() * 3 / 4);
  EXPECT_LT(after.landmark_count(), flown.world.atlas.landmark_count() * 3 / 4);
  EXPECT_EQ(after.keyframe_count(), flown.merged.keyframe_count() - economy->keyframes);
  EXPECT_EQ(economy->after.landmark_count(), after.landmark_count());
  EXPECT_THAT(Describe(*economy), ::testing::HasSubstr(std::to_string(economy->keyframes) + " redundant keyframes"));
}

TEST_P(Economy, WhatIsInUseStays) {
  const WeldedFlights flown = FlownTwice(GetParam());
  const std::vector<KeyframeId>& all = flown.world.KeyframesOf(kNewer);
  const std::set<KeyframeId> in_use(all.begin(), all.end());
  const auto economy = EconomizeMap(flown.merged, kMap, in_use, {}, {}, {}, {});
  ASSERT_TRUE(economy.has_value());
  const Atlas after = Economized(flown.merged, *economy);
  for (const KeyframeId id : in_use) EXPECT_NE(after.FindKeyframe(id), nullptr);
  EXPECT_LT(after.keyframe_count(), flown.merged.keyframe_count());
}

TEST(EconomyOfAMap, AStopGivesNothing) {
  const WeldedFlights flown = FlownTwice(1);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(EconomizeMap(flown.merged, kMap, {}, {}, {}, {}, stop.get_token()).has_value());
}

TEST(EconomyAgendaTest, AMapIsWorthItOnceItWasWeldedAndAgainWhenItGrewOrWasLeft) {
  SmallWorld world = RowOfThree();
  EconomyAgenda agenda(0.5, 2);
  EXPECT_FALSE(agenda.Next(world.atlas, {})) << "nothing was seen twice";
  world.Do(AddLoopEdge{K(3), K(1), {}});
  const std::set<KeyframeId> in_use{K(3)};
  EXPECT_EQ(agenda.Next(world.atlas, in_use), M(1));
  agenda.Start(M(1));
  agenda.Finish(world.atlas, in_use);
  EXPECT_FALSE(agenda.Next(world.atlas, in_use));
  EXPECT_EQ(agenda.Next(world.atlas, {}), M(1)) << "its agent left";
  agenda.Start(M(1));
  agenda.Finish(world.atlas, {});
  world.Child(K(4), K(3), M(1));
  EXPECT_FALSE(agenda.Next(world.atlas, {K(4)})) << "an agent works on what is new";
  world.Child(K(5), K(4), M(1));
  world.Child(K(6), K(5), M(1));
  EXPECT_EQ(agenda.Next(world.atlas, {K(6)}), M(1));
}

TEST(EconomyAgendaTest, AMapIsWorthItByItself) {
  SmallWorld world = RowOfThree();
  world.Do(AddLoopEdge{K(3), K(1), {}});
  EconomyAgenda agenda(0.5, 2);
  EXPECT_FALSE(agenda.Next(world.atlas, {}, M(2)));
  EXPECT_EQ(agenda.Next(world.atlas, {}, M(1)), M(1));
}

TEST(EconomyAgendaTest, WeldsCancelTheRunningOneOfTheirMapSoOftenAndNoMore) {
  SmallWorld world = RowOfThree();
  world.Do(AddLoopEdge{K(3), K(1), {}});
  EconomyAgenda agenda(0.5, 2);
  EXPECT_FALSE(agenda.MapWelded(M(1))) << "nothing runs";
  for (int i = 0; i < 2; ++i) {
    agenda.Start(M(1));
    EXPECT_FALSE(agenda.MapWelded(M(2))) << "another map";
    EXPECT_TRUE(agenda.MapWelded(M(1)));
    agenda.Cancel();
    EXPECT_EQ(agenda.Next(world.atlas, {}), M(1));
  }
  agenda.Start(M(1));
  EXPECT_FALSE(agenda.MapWelded(M(1)));
  agenda.Finish(world.atlas, {});
  agenda.Start(M(1));
  EXPECT_TRUE(agenda.MapWelded(M(1))) << "patient again";
}

TEST(EconomyAgendaTest, WhatAServerFindsWhenItStartsIsNotMadeSmallerAgain) {
  SmallWorld world = RowOfThree();
  world.Do(AddLoopEdge{K(3), K(1), {}});
  EconomyAgenda agenda(0.5, 2);
  agenda.Recover(world.atlas);
  EXPECT_FALSE(agenda.Next(world.atlas, {}));
  world.Child(K(4), K(3), M(1));
  EXPECT_EQ(agenda.Next(world.atlas, {}), M(1)) << "an agent was there since, and left";
}

}  // namespace
}  // namespace pangaea::testing
