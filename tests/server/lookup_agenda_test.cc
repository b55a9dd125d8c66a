#include "server/atlas/lookup_agenda.h"

#include <gtest/gtest.h>

#include "tests/map/small_world.h"

namespace pangaea {
namespace {

// A row of keyframes of one session, as they come.
void Grow(SmallWorld& world, SessionId session, std::uint32_t first, std::uint32_t last) {
  for (std::uint32_t i = first; i <= last; ++i) {
    if (i == 1) {
      world.Root(K(1, session), M(1, session));
    } else {
      world.Child(K(i, session), K(i - 1, session), M(1, session));
    }
  }
}

std::vector<KeyframeId> Rest(LookupAgenda& agenda) {
  std::vector<KeyframeId> ids;
  while (const auto id = agenda.Next()) ids.push_back(*id);
  return ids;
}

using Ids = std::vector<KeyframeId>;

TEST(LookupAgenda, EachKeyframeIsLookedUpOnceInTheOrderItCame) {
  SmallWorld world;
  LookupAgenda agenda({.recent = 8});
  Grow(world, kAnna, 1, 3);
  agenda.Update(world.atlas);
  EXPECT_EQ(Rest(agenda), (Ids{K(1), K(2), K(3)}));
  Grow(world, kAnna, 4, 4);
  agenda.Update(world.atlas);
  agenda.Update(world.atlas);
  EXPECT_EQ(Rest(agenda), Ids{K(4)});
}

TEST(LookupAgenda, SessionsTakeTurns) {
  SmallWorld world;
  LookupAgenda agenda({.recent = 8});
  Grow(world, kAnna, 1, 3);
  Grow(world, kBert, 1, 2);
  agenda.Update(world.atlas);
  EXPECT_EQ(Rest(agenda), (Ids{K(1), K(1, kBert), K(2), K(2, kBert), K(3)}));
}

TEST(LookupAgenda, InABurstTheNewestComeFirstAndNothingIsLeftOut) {
  SmallWorld world;
  LookupAgenda agenda({.recent = 2});
  Grow(world, kAnna, 1, 5);
  Grow(world, kBert, 1, 1);
  agenda.Update(world.atlas);
  EXPECT_EQ(agenda.waiting(), 6u);
  EXPECT_EQ(Rest(agenda), (Ids{K(4), K(1, kBert), K(5), K(3), K(2), K(1)}));
}

TEST(LookupAgenda, WhatCameMeanwhileGoesBeforeTheRestOfABurst) {
  SmallWorld world;
  LookupAgenda agenda({.recent = 1});
  Grow(world, kAnna, 1, 3);
  agenda.Update(world.atlas);
  EXPECT_EQ(agenda.Next(), K(3));
  EXPECT_EQ(agenda.Next(), K(2));
  Grow(world, kAnna, 4, 4);
  agenda.Update(world.atlas);
  EXPECT_EQ(Rest(agenda), (Ids{K(4), K(1)}));
}

TEST(LookupAgenda, WhatIsGoneIsToldAndNotLookedUp) {
  SmallWorld world;
  LookupAgenda agenda({.recent = 2});
  Grow(world, kAnna, 1, 5);
  agenda.Update(world.atlas);
  world.Do(RemoveKeyframe{K(5)});
  world.Do(RemoveKeyframe{K(2)});
  EXPECT_EQ(agenda.Update(world.atlas), (Ids{K(2), K(5)}));
  EXPECT_EQ(Rest(agenda), (Ids{K(4), K(3), K(1)}));
  EXPECT_TRUE(agenda.Update(world.atlas).empty());
}

TEST(LookupAgenda, OneThatShowsTooFewLandmarksIsLookedUpAgainWhenMoreOfThemHaveCome) {
  SmallWorld world;
  LookupAgenda agenda({.recent = 1});
  Grow(world, kAnna, 1, 3);
  agenda.Update(world.atlas);
  agenda.Defer(world.atlas, *agenda.Next());
  EXPECT_EQ(Rest(agenda), (Ids{K(2), K(1)}));
  Grow(world, kAnna, 4, 4);
  agenda.Update(world.atlas);
  EXPECT_EQ(Rest(agenda), Ids{K(4)}) << "nothing of it is new";
  world.Add(L(1), K(3), 1);
  agenda.Update(world.atlas);
  EXPECT_EQ(Rest(agenda), Ids{K(3)});
  agenda.Update(world.atlas);
  EXPECT_TRUE(Rest(agenda).empty());
}

}  // namespace
}  // namespace pangaea
