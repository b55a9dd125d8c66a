#include "common/map/forgetting.h"

#include <gtest/gtest.h>

#include <random>

#include "common/map/consistency.h"
#include "common/map/digest.h"
#include "common/map/trajectory.h"
#include "tests/map/random_edits.h"
#include "tests/map/small_world.h"

namespace pangaea {
namespace {

void ForgetOne(Atlas& atlas, KeyframeId id) { Forget(atlas, std::vector<ForgottenKeyframe>{{id}}); }

// In tree, map and trajectory the keyframe is what it was.
void ExpectPlaceKept(const Atlas& before, const Atlas& after, KeyframeId id) {
  const Keyframe& was = *before.FindKeyframe(id);
  const Keyframe* is = after.FindKeyframe(id);
  ASSERT_NE(is, nullptr);
  EXPECT_TRUE(IsForgotten(*is));
  EXPECT_TRUE(SameBits(is->camera_from_map, was.camera_from_map));
  EXPECT_EQ(is->parent, was.parent);
  EXPECT_EQ(is->children, was.children);
  EXPECT_EQ(is->map, was.map);
  EXPECT_EQ(is->data->stamp_ns, was.data->stamp_ns);
}

TEST(Forgetting, TakesWhatAKeyframeSawAndLeavesWhereItIs) {
  SmallWorld world = RowOfThree();
  const Atlas before = world.atlas;
  ForgetOne(world.atlas, K(2));
  EXPECT_TRUE(CheckConsistency(world.atlas).empty());
  ExpectPlaceKept(before, world.atlas, K(2));
  EXPECT_EQ(world.atlas.keyframe_count(), 3U);
  EXPECT_TRUE(world.Get(K(1)).covisible.empty());
  EXPECT_GT(world.atlas.version(), before.version());
  EXPECT_FALSE(IsForgotten(*before.FindKeyframe(K(2)))) << "snapshots stay as they were";
}

TEST(Forgetting, LandmarksThatOthersObserveStayAndTheRestLeavesNoTrace) {
  SmallWorld world = RowOfThree();
  ForgetOne(world.atlas, K(3));
  EXPECT_FALSE(world.atlas.Knows(L(3)));
  EXPECT_EQ(world.Get(L(2)).observations, (std::vector<Observation>{{K(2), 2}}));
  EXPECT_EQ(world.atlas.landmark_count(), 2U);
}

TEST(Forgetting, WhatWasFusedIntoAForgottenLandmarkLeavesNoTraceEither) {
  SmallWorld world = RowOfThree();
  world.Add(L(4), K(3), 5);
  world.Do(FuseLandmarks{L(3), L(4)});
  ForgetOne(world.atlas, K(3));
  EXPECT_FALSE(world.atlas.Knows(L(4)));
  EXPECT_TRUE(CheckConsistency(world.atlas).empty());
}

TEST(Forgetting, TwiceIsOnce) {
  SmallWorld world = RowOfThree();
  ForgetOne(world.atlas, K(3));
  const auto once = Fingerprint(world.atlas);
  ForgetOne(world.atlas, K(3));
  ForgetOne(world.atlas, K(9));
  EXPECT_EQ(Fingerprint(world.atlas), once);
}

TEST(Forgetting, WhateverMovesAForgottenKeyframeMovesItsFrames) {
  SmallWorld world = RowOfThree();
  world.Do(AddFramePoses{{{K(3), {77, MakePose(0.1, 0.2, 0, 0)}}}});
  SmallWorld whole = world;
  ForgetOne(world.atlas, K(3));
  for (SmallWorld* each : {&world, &whole}) {
    each->Do(
        MoveKeyframes{{{K(2), MakePose(0.2, 1, 2, 3), {}, {}, 2.0}, {K(3), MakePose(0.1, 0, 1, 0), {}, {}, 2.0}}, 5});
  }
  const auto expected = SessionTrajectory(whole.atlas, kAnna);
  const auto moved = SessionTrajectory(world.atlas, kAnna);
  ASSERT_EQ(moved.size(), expected.size());
  for (std::size_t i = 0; i < moved.size(); ++i) {
    EXPECT_TRUE(SameBits(moved[i].map_from_camera, expected[i].map_from_camera)) << i;
  }
}

TEST(Forgetting, AForgottenKeyframeMayBeCulledAndHandsItsFramesOn) {
  SmallWorld world = RowOfThree();
  world.Do(AddFramePoses{{{K(2), {77, MakePose(0.1, 0.2, 0, 0)}}}});
  const auto before = SessionTrajectory(world.atlas, kAnna);
  ForgetOne(world.atlas, K(2));
  world.Do(RemoveKeyframe{K(2)});
  EXPECT_EQ(world.Get(K(3)).parent, K(1));
  EXPECT_EQ(SessionTrajectory(world.atlas, kAnna).size(), before.size());
}

TEST(Forgetting, WhatWasForgottenComesBackWhereItIs) {
  SmallWorld world = RowOfThree();
  const Keyframe was = world.Get(K(3));
  ForgetOne(world.atlas, K(3));
  world.Refuse(AddObservation{L(2), K(3), 2}, ErrorCode::kInvalidArgument);
  world.Do(AddKeyframe{K(3), M(1), {}, {}, was.data});
  EXPECT_FALSE(IsForgotten(world.Get(K(3))));
  EXPECT_TRUE(SameBits(world.Get(K(3)).camera_from_map, was.camera_from_map));
  EXPECT_EQ(world.Get(K(3)).parent, K(2));
  world.Observe(L(2), K(3), 2);
  world.Do(AddLandmark{L(3), K(3), 3, {0, 0, 4}});
  EXPECT_EQ(world.Get(K(3)).covisible, was.covisible);
}

TEST(Forgetting, OnlyWhatWasForgottenComesBackAndAsItWas) {
  SmallWorld world = RowOfThree();
  world.Refuse(AddKeyframe{K(3), M(1), K(2), {}, MakeData(20)}, ErrorCode::kRefused);
  ForgetOne(world.atlas, K(3));
  world.Refuse(AddKeyframe{K(3), M(1), K(2), {}, MakeData(20, 12345)}, ErrorCode::kRefused);
  world.Refuse(AddKeyframe{K(3), M(1), K(2), {}, MakeData(0)}, ErrorCode::kRefused);
}

TEST(Forgetting, FramesThatAnotherAtlasHoldsAreShared) {
  SmallWorld one = RowOfThree();
  SmallWorld other = RowOfThree();
  for (SmallWorld* each : {&one, &other}) each->Do(AddFramePoses{{{K(3), {77, MakePose(0.1, 0.2, 0, 0)}}}});
  Forget(other.atlas, std::vector<ForgottenKeyframe>{{K(3), one.Get(K(3)).frames}});
  EXPECT_EQ(other.Get(K(3)).frames, one.Get(K(3)).frames);
  other = RowOfThree();
  other.Do(AddFramePoses{{{K(3), {77, MakePose(0.1, 0.3, 0, 0)}}}});
  Forget(other.atlas, std::vector<ForgottenKeyframe>{{K(3), one.Get(K(3)).frames}});
  EXPECT_NE(other.Get(K(3)).frames, one.Get(K(3)).frames) << "they are not the same";
}

TEST(Forgetting, EqualFramesOfTwoAtlasesCanBeShared) {
  SmallWorld one = RowOfThree();
  SmallWorld other = RowOfThree();
  for (SmallWorld* each : {&one, &other}) {
    each->Do(AddFramePoses{{{K(2), {77, MakePose(0.1, 0.2, 0, 0)}}, {K(3), {78, MakePose(0.1, 0.2, 0, 0)}}}});
  }
  other.Do(AddFramePoses{{{K(3), {79, MakePose(0.1, 0.2, 0, 0)}}}});
  const auto before = Fingerprint(other.atlas);
  ShareFrames(other.atlas, one.atlas);
  EXPECT_EQ(other.Get(K(2)).frames, one.Get(K(2)).frames);
  EXPECT_NE(other.Get(K(3)).frames, one.Get(K(3)).frames);
  EXPECT_EQ(Fingerprint(other.atlas), before);
}

TEST(Forgetting, TheDigestsOfAWholeAndOfATrimmedAtlasAgreeOnWhatBothHold) {
  SmallWorld whole = RowOfThree();
  SmallWorld trimmed = RowOfThree();
  ForgetOne(trimmed.atlas, K(3));
  EXPECT_NE(DigestOfSession(trimmed.atlas, kAnna), DigestOfSession(whole.atlas, kAnna));
  EXPECT_EQ(DigestOfSession(trimmed.atlas, kAnna), DigestOfSession(whole.atlas, kAnna, {K(3)}));
  whole.Do(MoveKeyframes{{{K(3), MakePose(0.1, 9, 0, 0)}}});
  EXPECT_NE(DigestOfSession(trimmed.atlas, kAnna), DigestOfSession(whole.atlas, kAnna, {K(3)})) << "where it is counts";
}

TEST(Forgetting, IdsThatLiveNoMoreAreGivenBack) {
  SmallWorld world = RowOfThree();
  // 5000 landmarks that failed their trial, as most do.
  for (std::uint32_t l = 10; l < 5010; ++l) {
    ASSERT_TRUE(Apply(AddLandmark{L(l), K(1), 7, {0, 0, 4}}, world.atlas));
    ASSERT_TRUE(Apply(RemoveLandmark{L(l)}, world.atlas));
  }
  ForgetOne(world.atlas, K(3));
  EXPECT_FALSE(world.atlas.Knows(L(100)));
  EXPECT_TRUE(world.atlas.Knows(L(5000))) << "a late edit may still speak of it";
  EXPECT_NE(world.atlas.FindLandmark(L(1)), nullptr);
  EXPECT_TRUE(CheckConsistency(world.atlas).empty());
}

class ForgettingProperty : public testing::TestWithParam<std::uint64_t> {};

TEST_P(ForgettingProperty, WhateverWasEditedAndForgottenTheAtlasIsConsistentAndTheTrajectoryWhole) {
  RandomEdits edits(GetParam());
  std::mt19937_64 random(GetParam());
  Atlas whole;
  Atlas trimmed;
  for (int step = 0; step < 400; ++step) {
    const MapEdit edit = edits.Next(whole);
    if (!Apply(edit, whole)) continue;
    (void)Apply(edit, trimmed);  // what speaks of something forgotten changes nothing there
    if (random() % 10 != 0) continue;
    std::vector<ForgottenKeyframe> some;
    trimmed.ForEachKeyframe([&](const Keyframe& keyframe) {
      if (random() % 4 == 0) some.push_back({keyframe.id, keyframe.frames});
    });
    Forget(trimmed, some);
    ASSERT_EQ(CheckConsistency(trimmed), std::vector<std::string>{}) << "step " << step;
  }
  EXPECT_EQ(trimmed.keyframe_count(), whole.keyframe_count());
}

INSTANTIATE_TEST_SUITE_P(Seeds, ForgettingProperty, testing::Range<std::uint64_t>(1, 21));

}  // namespace
}  // namespace pangaea
