#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "common/map/consistency.h"
#include "common/mapping/keyframe_redundancy.h"
#include "server/fusion/redundancy.h"
#include "tests/server/fusion_world.h"

namespace pangaea::testing {
namespace {

using ::testing::IsEmpty;
using ::testing::Not;

// A session that took many more keyframes than the place needs.
SurveyedWorld DenseMap(std::uint64_t seed) {
  SurveyedWorld world(seed);
  world.Fly(kOlder, CirclePoses(0, 39, 160), {});
  return world;
}

Atlas Culled(const Atlas& atlas, const std::vector<MapEdit>& edits) {
  Atlas culled = atlas;
  for (const MapEdit& edit : edits) EXPECT_TRUE(Apply(edit, culled).has_value());
  EXPECT_THAT(CheckConsistency(culled), IsEmpty());
  return culled;
}

class Redundancy : public ::testing::TestWithParam<std::uint64_t> {};
INSTANTIATE_TEST_SUITE_P(Seeds, Redundancy, ::testing::Range<std::uint64_t>(1, 4));

TEST_P(Redundancy, WhatRemainsIsNoLongerRedundantAndStillSeesNearlyAll) {
  const SurveyedWorld world = DenseMap(GetParam());
  const RedundancyOptions options;
  const Atlas culled = Culled(world.atlas, PlanCulling(world.atlas, {}, options, {}));
  EXPECT_LT(culled.keyframe_count(), world.atlas.keyframe_count() * 3 / 4);
  EXPECT_GT(culled.landmark_count(), world.atlas.landmark_count() * 95 / 100);
  culled.ForEachKeyframe([&](const Keyframe& keyframe) {
    if (keyframe.parent.valid()) {
      EXPECT_LT(RedundantShare(culled, keyframe, {.other_observers = 3, .coarser_octaves = 1}),
                options.redundant_share);
    }
  });
}

TEST_P(Redundancy, RootsLoopEndsAndKeyframesInUseStay) {
  SurveyedWorld world = DenseMap(GetParam());
  const std::vector<KeyframeId>& all = world.KeyframesOf(kOlder);
  ASSERT_TRUE(Apply(AddLoopEdge{all[20], all[10], {}}, world.atlas).has_value());
  const std::set<KeyframeId> in_use(all.begin() + 25, all.end());
  const Atlas culled = Culled(world.atlas, PlanCulling(world.atlas, in_use, {}, {}));
  EXPECT_LT(culled.keyframe_count(), world.atlas.keyframe_count());
  for (const KeyframeId id : in_use) EXPECT_NE(culled.FindKeyframe(id), nullptr);
  for (const KeyframeId id : {all[0], all[10], all[20]}) EXPECT_NE(culled.FindKeyframe(id), nullptr);
}

TEST(RedundancyBudget, NothingGoesWhereTheBudgetIsKept) {
  const SurveyedWorld world = DenseMap(1);
  RedundancyOptions options;
  options.max_bytes = EstimateBytes(world.atlas);
  EXPECT_THAT(PlanCulling(world.atlas, {}, options, {}), IsEmpty());
}

TEST(RedundancyBudget, OnlyAsMuchGoesAsTheBudgetAsks) {
  const SurveyedWorld world = DenseMap(1);
  RedundancyOptions options;
  options.max_bytes = EstimateBytes(world.atlas) * 9 / 10;
  const std::vector<MapEdit> edits = PlanCulling(world.atlas, {}, options, {});
  const Atlas culled = Culled(world.atlas, edits);
  EXPECT_LE(EstimateBytes(culled), options.max_bytes);
  EXPECT_GT(EstimateBytes(culled), options.max_bytes * 9 / 10);
}

TEST(RedundancyBudget, LandmarksThatOneKeyframeSeesGoWhenKeyframesAreNotEnough) {
  const SurveyedWorld world = DenseMap(1);
  RedundancyOptions options;
  options.max_bytes = 1;
  const Atlas culled = Culled(world.atlas, PlanCulling(world.atlas, {}, options, {}));
  culled.ForEachLandmark([&](const Landmark& landmark) { EXPECT_GE(landmark.observations.size(), 2U); });
  const std::set<KeyframeId> in_use(world.KeyframesOf(kOlder).begin(), world.KeyframesOf(kOlder).end());
  EXPECT_THAT(PlanCulling(world.atlas, in_use, options, {}), IsEmpty());
}

TEST(RedundancyBudget, AStoppedPlanIsShorterAndGood) {
  const SurveyedWorld world = DenseMap(1);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THAT(PlanCulling(world.atlas, {}, {}, stop.get_token()), IsEmpty());
}

TEST(RedundancyOptions, ANonsenseValueIsNamed) {
  RedundancyOptions options;
  EXPECT_TRUE(options.Check().has_value());
  options.redundant_share = 2.0;
  const Status status = options.Check();
  ASSERT_FALSE(status.has_value());
  EXPECT_THAT(status.error().message, ::testing::HasSubstr("redundant_share"));
}

}  // namespace
}  // namespace pangaea::testing
