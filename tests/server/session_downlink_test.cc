#include "server/downlink/session_downlink.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/server/two_sessions.h"

namespace pangaea {
namespace {

TEST(SessionDownlink, AnAgentThatSaysNothingOrThatNothingConcernsGetsNothing) {
  const SmallWorld world = TwoSessions();
  SessionDownlink silent(kBert, {});
  EXPECT_FALSE(silent.Next(View(world, 10, 10)));
  SessionDownlink unconcerned(kBert, {});
  unconcerned.Take(Interest(kBert, 0));
  EXPECT_FALSE(unconcerned.Next(View(world, 10, 10)));
}

TEST(SessionDownlink, AfterAMergeTheAgentIsToldWhatBecameOfItsMapAndWhoItsGuestsAre) {
  auto [world, downlink] = MergedForBert();
  const auto correction = downlink.Next(View(world, 11, 10));
  ASSERT_TRUE(correction);
  EXPECT_EQ(correction->version, First(11));
  EXPECT_EQ(correction->acknowledged, 7u);
  ASSERT_EQ(correction->pieces.size(), 1u);
  const MapPiece& piece = correction->pieces[0];
  EXPECT_EQ(piece.map, M(1));
  EXPECT_EQ(piece.merged, std::vector{M(1, kBert)});
  EXPECT_EQ(Ids(piece), (std::vector{K(1), K(2), K(3), K(1, kBert), K(2, kBert)}));
  for (const PieceKeyframe& keyframe : piece.keyframes) {
    EXPECT_EQ(keyframe.data != nullptr, keyframe.id.session == kAnna) << "it holds its own";
  }
  EXPECT_EQ(piece.fused, (std::vector<FusedLandmark>{{L(1, kBert), L(1)}}));
}

TEST(SessionDownlink, WhatComesUpWhileACorrectionIsUnderWayGoesIntoTheNextOne) {
  auto [world, downlink] = MergedForBert({.wanted = 0});
  ASSERT_TRUE(downlink.Next(View(world, 10, 10)));
  world.Do(MoveKeyframes{{{K(2, kBert), MakePose(0.1, 1, 0, 0)}}, 12});
  EXPECT_FALSE(downlink.Next(View(world, 12, 12))) << "the last one was not applied yet";
  downlink.Take(Interest(kBert, First(10)));
  const auto second = downlink.Next(View(world, 12, 12));
  ASSERT_TRUE(second);
  EXPECT_EQ(second->version, First(12));
  ASSERT_EQ(second->pieces.size(), 1u);
  EXPECT_TRUE(second->pieces[0].fused.empty()) << "it knows";
  downlink.Take(Interest(kBert, First(12)));
  EXPECT_FALSE(downlink.Next(View(world, 13, 12))) << "nothing concerns it any more";
}

TEST(SessionDownlink, ACorrectionThatWasLostIsSaidAgain) {
  auto [world, downlink] = MergedForBert();
  const auto lost = downlink.Next(View(world, 10, 10));
  ASSERT_TRUE(lost);
  downlink.Forget();
  const auto again = downlink.Next(View(world, 10, 10));
  ASSERT_TRUE(again);
  EXPECT_EQ(EncodePieces(again->pieces), EncodePieces(lost->pieces));
}

TEST(SessionDownlink, LandmarksThatFollowTheirReferenceAreNotSaid) {
  SmallWorld world = TwoSessions();
  SessionDownlink downlink(kAnna, {.wanted = 0});
  downlink.Take(Interest(kAnna, 0));
  world.Do(MoveKeyframes{{{K(2), MakePose(0.1, 1, 0, 0)}}, 10});
  ASSERT_TRUE(downlink.Next(View(world, 10, 10)));
  downlink.Take(Interest(kAnna, First(10)));
  // Landmark 1 is measured from keyframe 1 and moves on its own; landmark 3 goes with keyframe 3.
  const Landmark third = world.Get(L(3));
  world.Do(MoveKeyframes{{{K(3), MakePose(0.1, 2, 0, 0)}}, 12});
  const Eigen::Vector3d in_reference = {0.01, 0.02, 4.5};
  world.Do(MoveLandmarks{{{L(1), in_reference}}});
  world.Do(MoveLandmarks{{{L(3), Eigen::Vector3d(third.point_in_map.x(), third.point_in_map.y(), 4.0)}}});
  const auto correction = downlink.Next(View(world, 13, 13));
  ASSERT_TRUE(correction);
  ASSERT_EQ(correction->pieces.size(), 1u);
  const auto& landmarks = correction->pieces[0].landmarks;
  EXPECT_TRUE(std::ranges::any_of(landmarks, [](const PieceLandmark& listed) { return listed.id == L(1); }));
  EXPECT_FALSE(std::ranges::any_of(landmarks, [](const PieceLandmark& listed) { return listed.id == L(2); }));
}

TEST(SessionDownlink, ALandmarkThatNoneOfItsKeyframesObservesAnyMoreIsSaidThoughOthersDo) {
  auto [world, downlink] = MergedForBert({.wanted = 0});
  ASSERT_TRUE(downlink.Next(View(world, 10, 10)));
  downlink.Take(Interest(kBert, First(10)));
  world.Do(RemoveObservation{L(1), K(1, kBert)});
  world.Do(RemoveObservation{L(1), K(2, kBert)});
  const auto correction = downlink.Next(View(world, 11, 11));
  ASSERT_TRUE(correction);
  ASSERT_EQ(correction->pieces.size(), 1u);
  ASSERT_EQ(correction->pieces[0].landmarks.size(), 1u);
  EXPECT_EQ(correction->pieces[0].landmarks[0].id, L(1));
  EXPECT_TRUE(correction->pieces[0].landmarks[0].observations.empty());
}

TEST(SessionDownlink, AnUndoneMergeTakesTheGuestsAndTheirLandmarksAway) {
  const SmallWorld apart = TwoSessions();
  SmallWorld merged = apart;
  SessionDownlink downlink(kBert, {});
  downlink.Take(Interest(kBert, 0));
  Merge(merged, 10);
  const auto first = downlink.Next(View(merged, 10, 10));
  ASSERT_TRUE(first);
  downlink.Take(Interest(kBert, first->version, {K(1), K(2), K(3)}));
  // As undo leaves it: everything as it was, poses said anew.
  SmallWorld undone = apart;
  undone.Do(MoveKeyframes{{{K(1, kBert), Rigid3d()}}, 12});
  undone.Do(MoveKeyframes{{{K(1), Rigid3d()}}, 12});
  const auto correction = downlink.Next(View(undone, 12, 12));
  ASSERT_TRUE(correction);
  ASSERT_EQ(correction->pieces.size(), 1u) << "nothing is left to say of Anna's map";
  const MapPiece& piece = correction->pieces[0];
  EXPECT_EQ(piece.map, M(1, kBert));
  EXPECT_EQ(Ids(piece), (std::vector{K(1, kBert), K(2, kBert)}));
  ASSERT_EQ(piece.culled.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(piece.culled[i].id, K(static_cast<std::uint32_t>(i + 1)));
    EXPECT_FALSE(piece.culled[i].camera_from_map);
  }
  EXPECT_EQ(piece.removed, std::vector{L(1)});
  ASSERT_EQ(piece.landmarks.size(), 1u);
  EXPECT_EQ(piece.landmarks[0].id, L(1, kBert));
}

TEST(SessionDownlink, NewGuestsComeAFewAtATimeAndThoseItHoldsWithoutTheirFeatures) {
  auto [world, downlink] = MergedForBert({.new_at_once = 1});
  const auto first = downlink.Next(View(world, 10, 10));
  ASSERT_TRUE(first);
  std::vector<KeyframeId> guests;
  for (const KeyframeId id : Ids(first->pieces.at(0))) {
    if (id.session == kAnna) guests.push_back(id);
  }
  ASSERT_EQ(guests.size(), 1u);
  downlink.Take(Interest(kBert, First(10), guests));
  const auto second = downlink.Next(View(world, 11, 10));
  ASSERT_TRUE(second) << "there are more around its camera";
  for (const PieceKeyframe& keyframe : second->pieces.at(0).keyframes) {
    const bool is_new = keyframe.id.session == kAnna && keyframe.id != guests[0];
    EXPECT_EQ(keyframe.data != nullptr, is_new) << ToString(keyframe.id);
  }
}

TEST(SessionDownlink, GuestsGoOnComingWhileNothingIsJournaled) {
  auto [world, downlink] = MergedForBert({.new_at_once = 1});
  std::set<KeyframeId> guests;
  for (int i = 0; i < 3; ++i) {
    const auto correction = downlink.Next(View(world, 10, 10));
    ASSERT_TRUE(correction);
    EXPECT_EQ(correction->version, First(10) + static_cast<std::uint64_t>(i));
    for (const KeyframeId id : Ids(correction->pieces.at(0))) {
      if (id.session == kAnna) guests.insert(id);
    }
    downlink.Take(Interest(kBert, correction->version, {guests.begin(), guests.end()}));
  }
  EXPECT_EQ(guests.size(), 3u);
  EXPECT_FALSE(downlink.Next(View(world, 10, 10))) << "it holds all of them";
}

TEST(SessionDownlink, AGuestThatTheAgentDoesNotKeepIsNotSentAgainUntilItsCameraMoves) {
  auto [world, downlink] = MergedForBert({.wanted = 1});
  const auto first = downlink.Next(View(world, 10, 10));
  ASSERT_TRUE(first);
  downlink.Take(Interest(kBert, first->version));
  EXPECT_FALSE(downlink.Next(View(world, 10, 10)));
  MapInterest elsewhere = Interest(kBert, first->version);
  elsewhere.reference = K(2, kBert);
  downlink.Take(elsewhere);
  EXPECT_TRUE(downlink.Next(View(world, 10, 10)));
}

TEST(SessionDownlink, TheFoundPlaceOfALostAgentIsToldAlthoughItIsOfAMapThatTheAgentHasNoPartIn) {
  const SmallWorld world = TwoSessions();
  SessionDownlink downlink(kBert, {});
  downlink.Take(Interest(kBert, 0));
  EXPECT_FALSE(downlink.Next(View(world, 10, 0)));
  downlink.Show(K(2));
  const auto correction = downlink.Next(View(world, 10, 0));
  ASSERT_TRUE(correction);
  const auto piece = std::ranges::find(correction->pieces, M(1), &MapPiece::map);
  ASSERT_NE(piece, correction->pieces.end());
  EXPECT_EQ(Ids(*piece), (std::vector{K(1), K(2), K(3)}));
  for (const PieceKeyframe& keyframe : piece->keyframes) EXPECT_NE(keyframe.data, nullptr);
  EXPECT_FALSE(piece->landmarks.empty());
}

TEST(SessionDownlink, ThePlaceIsToldAlsoWhenTheAgentsInterestChangesBefore) {
  SmallWorld world = TwoSessions();
  SessionDownlink downlink(kBert, {});
  downlink.Take(Interest(kBert, 0));
  downlink.Show(K(2));
  MapInterest elsewhere = Interest(kBert, 0);
  elsewhere.reference = K(2, kBert);
  downlink.Take(elsewhere);
  const auto correction = downlink.Next(View(world, 10, 0));
  ASSERT_TRUE(correction);
  // Afterwards the agent says itself where it is.
  MapInterest there = Interest(kBert, correction->version, {K(1), K(2), K(3)});
  there.reference = K(2);
  downlink.Take(there);
  world.Child(K(3, kBert), K(2, kBert), M(1, kBert));
  EXPECT_FALSE(downlink.Next(View(world, 11, 0)));
}

TEST(SessionDownlink, OfAPlaceThatTheAgentHoldsNothingIsSaidAgain) {
  const SmallWorld world = TwoSessions();
  SessionDownlink downlink(kBert, {});
  downlink.Take(Interest(kBert, 0, {K(1), K(2), K(3)}));
  downlink.Show(K(2));
  EXPECT_FALSE(downlink.Next(View(world, 10, 0)));
}

// What the server took away before it told the agent anything is not in what the agent was told.
TEST(SessionDownlink, TheFirstCorrectionTellsOfAllThatIsGone) {
  SmallWorld world = TwoSessions();
  SessionDownlink downlink(kAnna, {.wanted = 0});
  downlink.Take(Interest(kAnna, 0));
  world.Do(MoveKeyframes{{{K(2), MakePose(0.1, 1, 0, 0)}}, 10});
  world.Do(RemoveLandmark{L(1)});
  world.Do(RemoveKeyframe{K(3)});
  world.Do(RemoveLandmark{L(1, kBert)});
  const auto correction = downlink.Next(View(world, 10, 10));
  ASSERT_TRUE(correction);
  ASSERT_EQ(correction->pieces.size(), 1u);
  const MapPiece& piece = correction->pieces[0];
  EXPECT_TRUE(std::ranges::binary_search(piece.removed, L(1)));
  EXPECT_FALSE(std::ranges::binary_search(piece.removed, L(1, kBert))) << "it never heard of it";
  ASSERT_EQ(piece.culled.size(), 1u);
  EXPECT_EQ(piece.culled[0].id, K(3));
  downlink.Take(Interest(kAnna, First(10)));
  world.Do(MoveKeyframes{{{K(2), MakePose(0.2, 1, 0, 0)}}, 11});
  const auto second = downlink.Next(View(world, 11, 11));
  ASSERT_TRUE(second);
  ASSERT_EQ(second->pieces.size(), 1u);
  EXPECT_TRUE(second->pieces[0].removed.empty()) << "it knows";
  EXPECT_TRUE(second->pieces[0].culled.empty());
}

TEST(SessionDownlink, OfSeveralMapsOneTellsWhatIsGoneAndEachWhatWasFusedInIt) {
  SmallWorld world = RowOfThree();
  world.Root(K(10), M(2));
  world.Child(K(11), K(10), M(2));
  world.Add(L(20), K(10), 1);
  world.Add(L(21), K(10), 2);
  SessionDownlink downlink(kAnna, {.wanted = 0});
  downlink.Take(Interest(kAnna, 0));
  world.Do(MoveKeyframes{{{K(2), MakePose(0.1, 1, 0, 0)}, {K(11), MakePose(0.1, 1, 0, 0)}}, 10});
  world.Do(RemoveLandmark{L(1)});
  world.Do(FuseLandmarks{L(20), L(21)});
  const auto correction = downlink.Next(View(world, 10, 10));
  ASSERT_TRUE(correction);
  ASSERT_EQ(correction->pieces.size(), 2u);
  EXPECT_EQ(correction->pieces[0].removed, std::vector{L(1)});
  EXPECT_TRUE(correction->pieces[1].removed.empty());
  EXPECT_EQ(correction->pieces[1].fused, (std::vector<FusedLandmark>{{L(21), L(20)}}));
}

}  // namespace
}  // namespace pangaea
