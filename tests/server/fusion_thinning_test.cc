#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "common/map/consistency.h"
#include "server/fusion/landmark_thinning.h"
#include "tests/server/fusion_world.h"

namespace pangaea::testing {
namespace {

using ::testing::IsEmpty;
using ::testing::Not;

constexpr MapId kMap{kOlder, 1};

SurveyedWorld OneMap(std::uint64_t seed) {
  SurveyedWorld world(seed);
  world.Fly(kOlder, CirclePoses(0, 15, 60), {});
  return world;
}

std::size_t SeenBy(const Keyframe& keyframe) {
  return static_cast<std::size_t>(std::ranges::count_if(keyframe.landmarks, [](LandmarkId id) { return id.valid(); }));
}

class Thinning : public ::testing::TestWithParam<std::uint64_t> {
 protected:
  Thinning() : world_(OneMap(GetParam())) {
    world_.atlas.ForEachKeyframe([&](const Keyframe& keyframe) { fewest_ = std::min(fewest_, SeenBy(keyframe)); });
    options_.kept = fewest_ / 2;
    options_.kept_in_cell = 2;
  }

  Atlas Thinned(const std::set<KeyframeId>& in_use = {}) const {
    Atlas thinned = world_.atlas;
    for (const MapEdit& edit : PlanThinning(world_.atlas, kMap, in_use, options_, {})) {
      EXPECT_TRUE(Apply(edit, thinned).has_value());
    }
    EXPECT_THAT(CheckConsistency(thinned), IsEmpty());
    return thinned;
  }

  SurveyedWorld world_;
  std::size_t fewest_ = 100000;
  ThinningOptions options_;
};
INSTANTIATE_TEST_SUITE_P(Seeds, Thinning, ::testing::Range<std::uint64_t>(1, 4));

TEST_P(Thinning, EachKeyframeKeepsEnoughAndOnlyWeakLandmarksGo) {
  const Atlas thinned = Thinned();
  EXPECT_LT(thinned.landmark_count(), world_.atlas.landmark_count() * 9 / 10);
  thinned.ForEachKeyframe([&](const Keyframe& keyframe) { EXPECT_GE(SeenBy(keyframe), options_.kept); });
  world_.atlas.ForEachLandmark([&](const Landmark& landmark) {
    if (landmark.observations.size() > options_.max_observers) {
      EXPECT_NE(thinned.FindLandmark(landmark.id), nullptr);
    }
  });
}

TEST_P(Thinning, WhatLivingAgentsLookAtStays) {
  const std::vector<KeyframeId>& all = world_.KeyframesOf(kOlder);
  const std::set<KeyframeId> in_use(all.begin(), all.begin() + 5);
  const Atlas thinned = Thinned(in_use);
  EXPECT_LT(thinned.landmark_count(), world_.atlas.landmark_count());
  for (const KeyframeId id : in_use) {
    EXPECT_EQ(thinned.FindKeyframe(id)->landmarks, world_.atlas.FindKeyframe(id)->landmarks);
  }
}

TEST_P(Thinning, DoneTwiceItFindsNothingMore) {
  world_.atlas = Thinned();
  EXPECT_THAT(PlanThinning(world_.atlas, kMap, {}, options_, {}), IsEmpty());
}

TEST(ThinningOfSessions, WhatTwoSessionsSeeStays) {
  SurveyedWorld world = TwoMaps(1);
  const WeldingOutcome plan = PlanWelding(world.atlas, MiddleMatch(world), {}, {});
  ASSERT_TRUE(plan.has_value());
  Carry(*plan, world.atlas);
  ThinningOptions options;
  options.kept = 20;
  options.kept_in_cell = 0;
  options.max_observers = 100;
  const std::vector<MapEdit> edits = PlanThinning(world.atlas, plan->map, {}, options, {});
  EXPECT_THAT(edits, Not(IsEmpty()));
  for (const MapEdit& edit : edits) {
    const Landmark& landmark = *world.atlas.FindLandmark(std::get<RemoveLandmark>(edit).id);
    EXPECT_EQ(landmark.observations.front().keyframe.session, landmark.observations.back().keyframe.session);
  }
}

TEST(ThinningOfSessions, AStoppedPlanIsShorterAndGood) {
  const SurveyedWorld world = OneMap(1);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THAT(PlanThinning(world.atlas, kMap, {}, {}, stop.get_token()), IsEmpty());
}

TEST(ThinningOptions, ANonsenseValueIsNamed) {
  ThinningOptions options;
  EXPECT_TRUE(options.Check().has_value());
  options.cell = 0;
  const Status status = options.Check();
  ASSERT_FALSE(status.has_value());
  EXPECT_THAT(status.error().message, ::testing::HasSubstr("cell"));
}

}  // namespace
}  // namespace pangaea::testing
