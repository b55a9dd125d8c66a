// What an agent that claims to hold the same is answered.
#include <gtest/gtest.h>

#include "common/map/digest.h"
#include "tests/server/two_sessions.h"

namespace pangaea {
namespace {

MapInterest Claim(std::uint64_t applied, const DigestClaim& claim) {
  MapInterest interest = Interest(kAnna, applied);
  interest.claim = claim;
  return interest;
}

TEST(SessionDownlink, AClaimIsFoundTrueOnceTheServerIsAsFar) {
  const SmallWorld world = TwoSessions();
  SessionDownlink downlink(kAnna, {.wanted = 0});
  downlink.Take(Claim(0, {1, 8, DigestOfSession(world.atlas, kAnna)}));
  EXPECT_FALSE(downlink.Next(View(world, 10, 0)));
  EXPECT_EQ(downlink.agreed_claim(), 0U) << "it has seven envelopes";
  downlink.Take(Claim(0, {2, 7, DigestOfSession(world.atlas, kAnna)}));
  EXPECT_FALSE(downlink.Next(View(world, 10, 0)));
  EXPECT_EQ(downlink.agreed_claim(), 2U);
}

TEST(SessionDownlink, WhereAClaimIsWrongAndWhatChangedDoesNotMendItEverythingIsToldAnewUntilItArrived) {
  const SmallWorld world = TwoSessions();
  SessionDownlink downlink(kAnna, {.wanted = 0});
  const std::uint64_t digest = DigestOfSession(world.atlas, kAnna);
  downlink.Take(Claim(0, {1, 7, digest + 1}));
  const auto changes = downlink.Next(View(world, 10, 0));
  ASSERT_TRUE(changes);
  EXPECT_FALSE(changes->complete);
  EXPECT_TRUE(changes->pieces.at(0).landmarks.empty());
  downlink.Take(Claim(changes->version, {2, 7, digest + 1}));
  const auto correction = downlink.Next(View(world, 10, 0));
  ASSERT_TRUE(correction);
  EXPECT_TRUE(correction->complete);
  const MapPiece& piece = correction->pieces.at(0);
  EXPECT_EQ(Ids(piece), (std::vector{K(1), K(2), K(3)}));
  for (const PieceKeyframe& keyframe : piece.keyframes) EXPECT_EQ(keyframe.data, nullptr) << "it holds them";
  std::vector<LandmarkId> landmarks;
  for (const PieceLandmark& landmark : piece.landmarks) landmarks.push_back(landmark.id);
  EXPECT_EQ(landmarks, (std::vector{L(1), L(2), L(3)}));
  EXPECT_FALSE(downlink.Next(View(world, 10, 0))) << "it is under way";
  downlink.Forget();
  const auto again = downlink.Next(View(world, 10, 0));
  ASSERT_TRUE(again);
  EXPECT_TRUE(again->complete);
  downlink.Take(Claim(again->version, {3, 7, digest}));
  EXPECT_FALSE(downlink.Next(View(world, 10, 0)));
  EXPECT_EQ(downlink.agreed_claim(), 3U);
}

// Another agent's edits are no corrections of the server's.
TEST(SessionDownlink, WhatAnotherAgentChangedOfWhatBothSeeIsToldInAnswerToAClaim) {
  auto [world, downlink] = MergedForBert({.wanted = 0});
  const auto merged = downlink.Next(View(world, 10, 10));
  ASSERT_TRUE(merged);
  MapInterest interest = Interest(kBert, merged->version);
  interest.claim = {1, 7, DigestOfSession(world.atlas, kBert)};
  world.Do(RemoveLandmark{L(1)});
  downlink.Take(interest);
  const auto correction = downlink.Next(View(world, 12, 10));
  ASSERT_TRUE(correction);
  EXPECT_FALSE(correction->complete);
  EXPECT_EQ(correction->pieces.at(0).removed, std::vector{L(1)});
}

// Each answer may come too late while others fly, but not for ever.
TEST(SessionDownlink, WhileOthersGoOnChangingTheMapThreeAnswersTellWhatChangedBeforeOneTellsEverything) {
  const SmallWorld world = TwoSessions();
  SessionDownlink downlink(kAnna, {.wanted = 0});
  std::uint64_t applied = 0;
  for (std::uint64_t number = 1; number <= 4; ++number) {
    downlink.Take(Claim(applied, {number, 7, 5}));
    const auto answer = downlink.Next(View(world, 10 + number, 0));
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->complete, number == 4) << number;
    applied = answer->version;
  }
}

TEST(SessionDownlink, WhatTheAgentHasForgottenIsNoPartOfItsClaim) {
  const SmallWorld world = TwoSessions();
  SessionDownlink downlink(kAnna, {.wanted = 0});
  MapInterest interest = Claim(0, {1, 7, DigestOfSession(world.atlas, kAnna, {K(3)})});
  interest.held = {K(1), K(2), K(4)};
  downlink.Take(interest);
  EXPECT_FALSE(downlink.Next(View(world, 10, 0)));
  EXPECT_EQ(downlink.agreed_claim(), 1U);
  interest.claim = {2, 7, 5};
  downlink.Take(interest);
  const auto changes = downlink.Next(View(world, 10, 0));
  ASSERT_TRUE(changes);
  interest.claim.number = 3;
  interest.applied_version = changes->version;
  downlink.Take(interest);
  const auto correction = downlink.Next(View(world, 10, 0));
  ASSERT_TRUE(correction);
  EXPECT_TRUE(correction->complete);
  for (const PieceLandmark& landmark : correction->pieces.at(0).landmarks) EXPECT_NE(landmark.id, L(3));
}

}  // namespace
}  // namespace pangaea
