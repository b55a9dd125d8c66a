#include "agent/uplink/kept_keyframes.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/map/forgetting.h"
#include "tests/map/small_world.h"

namespace pangaea {
namespace {

constexpr KeptKeyframesOptions kFew{.most = 8, .left = 6, .recalled = 3, .newest = 1, .window = 1};

// A corridor: Anna's keyframes one behind the other, half a metre apart, each sharing a landmark with the next.
SmallWorld Corridor(std::uint32_t length) {
  SmallWorld world;
  world.Root(K(1), M(1));
  for (std::uint32_t k = 2; k <= length; ++k) {
    world.Child(K(k), K(k - 1), M(1));
    world.Add(L(k), K(k - 1), 2);
    world.Observe(L(k), K(k), 3);
  }
  return world;
}

std::vector<KeyframeId> Sorted(std::vector<KeyframeId> ids) {
  std::ranges::sort(ids);
  return ids;
}

void ForgetAll(Atlas& atlas, const std::vector<KeyframeId>& ids) {
  std::vector<ForgottenKeyframe> forgotten;
  for (const KeyframeId id : ids) forgotten.push_back({id});
  Forget(atlas, forgotten);
}

TEST(KeptKeyframes, OptionsThatWouldForgetAndRecallTheSameAreRefused) {
  EXPECT_TRUE(KeptKeyframesOptions{}.Check());
  EXPECT_TRUE(kFew.Check());
  for (const std::size_t left : {5, 60, 1000}) EXPECT_TRUE(KeptKeyframesOptions::Of(left, left).Check());
  EXPECT_TRUE((KeptKeyframesOptions{.most = 0, .left = 9}.Check())) << "nothing is forgotten";
  EXPECT_FALSE((KeptKeyframesOptions{.most = 100, .left = 101}.Check()));
  EXPECT_FALSE((KeptKeyframesOptions{.left = 40, .recalled = 40}.Check()));
}

TEST(KeptKeyframes, NothingIsForgottenUntilThereAreTooMany) {
  const SmallWorld world = Corridor(8);
  EXPECT_TRUE(ChooseForgotten(world.atlas, world.atlas, K(8), kAnna, kFew).empty());
  const SmallWorld longer = Corridor(9);
  EXPECT_TRUE(ChooseForgotten(longer.atlas, longer.atlas, K(9), kAnna, {.most = 0}).empty());
}

TEST(KeptKeyframes, TheFarthestFromTheCameraAreForgotten) {
  const SmallWorld world = Corridor(9);
  EXPECT_EQ(Sorted(ChooseForgotten(world.atlas, world.atlas, K(9), kAnna, kFew)), (std::vector{K(1), K(2), K(3)}));
  EXPECT_EQ(Sorted(ChooseForgotten(world.atlas, world.atlas, K(1), kAnna, kFew)), (std::vector{K(6), K(7), K(8)}))
      << "it came back to where it began; the newest stays";
}

TEST(KeptKeyframes, WhatTheServerDoesNotHaveJustAsWellIsKept) {
  SmallWorld world = Corridor(9);
  EXPECT_TRUE(ChooseForgotten(world.atlas, Atlas(), K(9), kAnna, kFew).empty()) << "without a server all of it";
  const SmallWorld confirmed = world;
  world.Add(L(50), K(1), 9);
  world.Observe(L(50), K(5), 9);
  world.Do(AddFramePoses{{{K(2), {77, MakePose(0.1, 0.2, 0, 0)}}}});
  const auto forgotten = Sorted(ChooseForgotten(world.atlas, confirmed.atlas, K(9), kAnna, kFew));
  EXPECT_EQ(forgotten, (std::vector{K(3), K(4), K(6)}));
}

TEST(KeptKeyframes, WhatAKeyframeAloneSeesIsNoReasonToKeepIt) {
  SmallWorld world = Corridor(9);
  const SmallWorld confirmed = world;
  world.Add(L(50), K(1), 9);  // the uplink waits for a second observation
  EXPECT_EQ(Sorted(ChooseForgotten(world.atlas, confirmed.atlas, K(9), kAnna, kFew)), (std::vector{K(1), K(2), K(3)}));
}

TEST(KeptKeyframes, WhatTracksAndMapsIsKeptHoweverMany) {
  const SmallWorld world = Corridor(9);
  const KeptKeyframesOptions new_ones{.most = 8, .left = 6, .recalled = 3, .newest = 5, .window = 1};
  const auto forgotten = ChooseForgotten(world.atlas, world.atlas, K(9), kAnna, new_ones);
  EXPECT_TRUE(std::ranges::all_of(forgotten, [](KeyframeId id) { return id <= K(4); }));
  const KeptKeyframesOptions window{.most = 8, .left = 6, .recalled = 3, .newest = 1, .window = 7};
  EXPECT_EQ(Sorted(ChooseForgotten(world.atlas, world.atlas, K(9), kAnna, window)), (std::vector{K(1), K(2)}))
      << "seven are bound together by what they see";
}

TEST(KeptKeyframes, KeyframesOfOtherMapsAreForgottenFirst) {
  SmallWorld world = Corridor(8);
  world.Root(K(20, kBert), M(1, kBert));
  const auto forgotten = ChooseForgotten(world.atlas, world.atlas, K(8), kAnna, kFew);
  EXPECT_EQ(forgotten.front(), K(20, kBert));
}

TEST(KeptKeyframes, ACameraThatGoesToAndFroForgetsNothing) {
  SmallWorld world = Corridor(9);
  ForgetAll(world.atlas, ChooseForgotten(world.atlas, world.atlas, K(9), kAnna, kFew));
  for (std::uint32_t k = 9; k >= 6; --k) {
    EXPECT_TRUE(ChooseForgotten(world.atlas, world.atlas, K(k), kAnna, kFew).empty()) << k;
    EXPECT_TRUE(InterestOf(kAnna, world.atlas, world.atlas, K(k), kFew).wanted.empty()) << k;
  }
}

TEST(KeptKeyframes, WhereNothingIsForgottenTheInterestSaysSo) {
  const SmallWorld world = Corridor(9);
  const MapInterest interest = InterestOf(kAnna, world.atlas, world.atlas, K(9), kFew);
  EXPECT_EQ(interest.session, kAnna);
  EXPECT_EQ(interest.map, M(1));
  EXPECT_EQ(interest.reference, K(9));
  EXPECT_TRUE(interest.held.empty());
  EXPECT_TRUE(interest.wanted.empty());
}

TEST(KeptKeyframes, TheCameraIsNearToAKeyframeThatTheServerKnows) {
  const SmallWorld world = Corridor(9);
  const SmallWorld confirmed = Corridor(7);
  EXPECT_EQ(InterestOf(kAnna, world.atlas, confirmed.atlas, K(9), kFew).reference, K(7));
  EXPECT_EQ(InterestOf(kAnna, world.atlas, Atlas(), K(9), kFew).reference, K(9));
}

TEST(KeptKeyframes, ForgottenOnesAreAskedBackWhenTheCameraComesNear) {
  SmallWorld world = Corridor(9);
  world.Child(K(1, kBert), K(1), M(1));
  ForgetAll(world.atlas, {K(1), K(2), K(3), K(1, kBert)});
  const MapInterest far = InterestOf(kAnna, world.atlas, world.atlas, K(9), kFew);
  EXPECT_TRUE(far.wanted.empty());
  EXPECT_TRUE(far.guests.empty());
  EXPECT_EQ(far.held, (std::vector{K(4), K(5), K(6), K(7), K(8), K(9)}));
  const MapInterest near = InterestOf(kAnna, world.atlas, world.atlas, K(4), kFew);
  EXPECT_EQ(near.wanted, (std::vector{K(3)})) << "among the three nearest, with itself and the one after";
  const MapInterest there = InterestOf(kAnna, world.atlas, world.atlas, K(2), kFew);
  EXPECT_EQ(there.wanted.size(), 3U);
  EXPECT_EQ(there.wanted[0], K(2));
  EXPECT_EQ(there.wanted[1], K(1, kBert)) << "guests as well";
}

TEST(KeptKeyframes, AsLongAsOnlyOneSideHasForgottenItItIsHeld) {
  SmallWorld world = Corridor(9);
  const Atlas confirmed = world.atlas;  // acks have not come as far
  ForgetAll(world.atlas, {K(1), K(2), K(3)});
  const MapInterest interest = InterestOf(kAnna, world.atlas, confirmed, K(2), kFew);
  EXPECT_TRUE(interest.held.empty());
  EXPECT_TRUE(interest.wanted.empty());
}

}  // namespace
}  // namespace pangaea
