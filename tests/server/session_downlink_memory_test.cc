// What an agent is told of what it has forgotten, and what it asks back.
#include <gtest/gtest.h>

#include "tests/server/two_sessions.h"

namespace pangaea {
namespace {

TEST(SessionDownlink, AfterARestartOfTheServerTheAgentIsToldWhatIsNewerThanWhatItApplied) {
  SmallWorld world = TwoSessions();
  Merge(world, 10);
  SessionDownlink downlink(kBert, {.wanted = 0});
  downlink.Take(Interest(kBert, First(10)));
  EXPECT_FALSE(downlink.Next(View(world, 11, 10))) << "it applied all there is";
  world.Do(MoveKeyframes{{{K(2, kBert), MakePose(0.1, 1, 0, 0)}}, 12});
  const auto correction = downlink.Next(View(world, 12, 12));
  ASSERT_TRUE(correction);
  EXPECT_EQ(correction->pieces.at(0).landmarks.at(0).id, L(1)) << "seen by the keyframe that moved";
}

TEST(SessionDownlink, WhatTheAgentAsksBackComesAsItIsWithAllItsLandmarks) {
  SmallWorld world = TwoSessions();
  SessionDownlink downlink(kAnna, {.wanted = 0});
  MapInterest interest = Interest(kAnna, 0);
  interest.held = {K(1), K(2)};
  // Held keyframes are not asked for, nor what is newer than the interest.
  interest.wanted = {K(3), K(1), K(99)};
  world.Child(K(4), K(3), M(1));
  downlink.Take(interest);
  interest.held = {K(1), K(2), K(4)};
  downlink.Take(interest);
  const auto correction = downlink.Next(View(world, 10, 0));
  ASSERT_TRUE(correction);
  ASSERT_EQ(correction->pieces.size(), 1u);
  const MapPiece& piece = correction->pieces[0];
  EXPECT_EQ(Ids(piece), (std::vector{K(1), K(2), K(3), K(4)})) << "where all of them are";
  for (const PieceKeyframe& keyframe : piece.keyframes) EXPECT_EQ(keyframe.data != nullptr, keyframe.id == K(3));
  ASSERT_EQ(piece.landmarks.size(), 2u);
  EXPECT_EQ(piece.landmarks[0].id, L(2));
  EXPECT_EQ(piece.landmarks[0].observations.size(), 2u);
  EXPECT_EQ(piece.landmarks[1].id, L(3));
  interest.held = {K(1), K(2), K(3), K(4)};
  interest.wanted.clear();
  interest.applied_version = correction->version;
  downlink.Take(interest);
  EXPECT_FALSE(downlink.Next(View(world, 11, 0)));
}

TEST(SessionDownlink, OfWhatTheAgentHasForgottenItIsToldWhereItIsAlone) {
  SmallWorld world = TwoSessions();
  SessionDownlink downlink(kAnna, {.wanted = 0});
  MapInterest interest = Interest(kAnna, 0);
  interest.held = {K(1), K(2)};
  downlink.Take(interest);
  // Newer than what it says: held.
  world.Child(K(4), K(2), M(1));
  world.Add(L(4), K(4), 1);
  interest.held = {K(1), K(2), K(4)};
  downlink.Take(interest);
  world.Do(MoveKeyframes{{{K(2), MakePose(0.1, 1, 0, 0)}, {K(3), MakePose(0.1, 1, 0, 0)}}, 10});
  world.Do(MoveLandmarks{{{L(3), Eigen::Vector3d(0, 0, 3)}}});
  const auto correction = downlink.Next(View(world, 10, 10));
  ASSERT_TRUE(correction);
  const MapPiece& piece = correction->pieces.at(0);
  EXPECT_EQ(Ids(piece), (std::vector{K(1), K(2), K(3), K(4)}));
  for (const PieceLandmark& landmark : piece.landmarks) EXPECT_NE(landmark.id, L(3));
}

TEST(SessionDownlink, AGuestThatTheAgentForgotComesAgainOnlyWhenItIsAskedFor) {
  auto [world, downlink] = MergedForBert();
  ASSERT_TRUE(downlink.Next(View(world, 10, 10)));
  downlink.Take(Interest(kBert, First(10), {K(1), K(2), K(3)}));
  EXPECT_FALSE(downlink.Next(View(world, 11, 10)));
  MapInterest interest = Interest(kBert, First(10), {K(2), K(3)});
  downlink.Take(interest);
  EXPECT_FALSE(downlink.Next(View(world, 11, 10))) << "it had its reasons";
  interest.wanted = {K(1)};
  downlink.Take(interest);
  const auto correction = downlink.Next(View(world, 11, 10));
  ASSERT_TRUE(correction);
  for (const PieceKeyframe& keyframe : correction->pieces.at(0).keyframes) {
    EXPECT_EQ(keyframe.data != nullptr, keyframe.id == K(1)) << ToString(keyframe.id);
  }
}

TEST(SessionDownlink, WhereALostAgentIsFoundItGetsWhatItHasForgottenToo) {
  const SmallWorld world = TwoSessions();
  SessionDownlink downlink(kAnna, {});
  MapInterest interest = Interest(kAnna, 0);
  interest.held = {K(1)};
  downlink.Take(interest);
  interest.held = {K(1), K(4)};  // one that did not come as far
  downlink.Take(interest);
  EXPECT_FALSE(downlink.Next(View(world, 10, 0))) << "it asks for none of it";
  downlink.Show(K(3));
  const auto correction = downlink.Next(View(world, 10, 0));
  ASSERT_TRUE(correction);
  for (const PieceKeyframe& keyframe : correction->pieces.at(0).keyframes) {
    EXPECT_EQ(keyframe.data != nullptr, keyframe.id != K(1)) << ToString(keyframe.id);
  }
}

}  // namespace
}  // namespace pangaea
