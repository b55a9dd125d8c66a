#include "server/atlas/welding_agenda.h"

#include <gtest/gtest.h>

#include "tests/map/small_world.h"

namespace pangaea {
namespace {

constexpr SessionId kCarl = 0xc;

// Anna's row of three, and maps of Bert and Carl with two keyframes each.
SmallWorld ThreeMaps() {
  SmallWorld world = RowOfThree();
  for (const SessionId session : {kBert, kCarl}) {
    world.Root(K(1, session), M(1, session));
    world.Child(K(2, session), K(1, session), M(1, session));
  }
  return world;
}

PlaceMatch Match(KeyframeId query, KeyframeId candidate) {
  PlaceMatch match;
  match.query = query;
  match.candidate = candidate;
  return match;
}

void Merge(SmallWorld& world, SessionId absorbed) {
  world.Do(MergeMaps{M(1), M(1, absorbed), {}, K(1, absorbed), K(1)});
}

bool NoneWaits(MapId) { return false; }

TEST(WeldingAgenda, MergesGoBeforeLoopsAndOtherwiseTheFirstFoundIsTheFirstWelded) {
  const SmallWorld world = ThreeMaps();
  WeldingAgenda agenda({}, {});
  agenda.Add(Match(K(3), K(1)));
  agenda.Add(Match(K(1, kBert), K(1)));
  agenda.Add(Match(K(1, kCarl), K(2)));
  EXPECT_EQ(agenda.Next(world.atlas, NoneWaits)->query, K(1, kBert));
  EXPECT_EQ(agenda.Next(world.atlas, NoneWaits)->query, K(1, kCarl));
  EXPECT_EQ(agenda.Next(world.atlas, NoneWaits)->query, K(3));
  EXPECT_FALSE(agenda.Next(world.atlas, NoneWaits));
}

TEST(WeldingAgenda, AMatchBetweenMapsThatWereMergedMeanwhileIsALoop) {
  SmallWorld world = ThreeMaps();
  WeldingAgenda agenda({}, {});
  agenda.Add(Match(K(2, kBert), K(3)));
  Merge(world, kBert);
  const auto waits = [](MapId map) { return map == M(1); };
  EXPECT_FALSE(agenda.Next(world.atlas, waits)) << "loops in that map have to wait";
  EXPECT_EQ(agenda.waiting(), 1u);
  EXPECT_TRUE(agenda.Next(world.atlas, NoneWaits));
}

TEST(WeldingAgenda, WhatIsJoinedAlreadyOrGoneIsDropped) {
  SmallWorld world = ThreeMaps();
  WeldingAgenda agenda({.joined_landmarks = 1}, {});
  agenda.Add(Match(K(2), K(1)));                // they share landmark 1
  agenda.Add(Match(K(2, kBert), K(1, kBert)));  // one forwards to the other, below
  agenda.Add(Match(K(77), K(1)));
  world.Do(RemoveKeyframe{K(2, kBert)});
  EXPECT_FALSE(agenda.Next(world.atlas, NoneWaits));
  EXPECT_EQ(agenda.waiting(), 0u);
  EXPECT_EQ(agenda.dropped(), 3u);
}

TEST(WeldingAgenda, MapsThatWereTakenApartAreNotMergedAgainAlsoNotUnderAnotherName) {
  SmallWorld world = ThreeMaps();
  WeldingAgenda agenda({}, {{M(1, kBert), M(1)}});
  agenda.Add(Match(K(1, kBert), K(1)));
  EXPECT_FALSE(agenda.Next(world.atlas, NoneWaits));
  agenda.Add(Match(K(1, kBert), K(1, kCarl)));
  EXPECT_TRUE(agenda.Next(world.atlas, NoneWaits));
  Merge(world, kCarl);
  agenda.Add(Match(K(1, kBert), K(1, kCarl)));
  EXPECT_FALSE(agenda.Next(world.atlas, NoneWaits)) << "Carl's map is a part of Anna's now";
}

TEST(WeldingAgenda, WhenTooManyWaitLoopsAreGivenUpFirst) {
  const SmallWorld world = ThreeMaps();
  WeldingAgenda agenda({.capacity = 2}, {});
  agenda.Add(Match(K(1, kBert), K(1)));
  agenda.Add(Match(K(3), K(1)));
  agenda.Add(Match(K(1, kCarl), K(1)));
  EXPECT_EQ(agenda.waiting(), 2u);
  EXPECT_EQ(agenda.Next(world.atlas, NoneWaits)->query, K(1, kBert));
  EXPECT_EQ(agenda.Next(world.atlas, NoneWaits)->query, K(1, kCarl));
}

}  // namespace
}  // namespace pangaea
