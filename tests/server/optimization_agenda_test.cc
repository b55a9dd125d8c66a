#include "server/atlas/optimization_agenda.h"

#include <gtest/gtest.h>

#include "tests/map/small_world.h"

namespace pangaea {
namespace {

SmallWorld TwoMaps() {
  SmallWorld world = RowOfThree();
  world.Root(K(1, kBert), M(1, kBert));
  world.Child(K(2, kBert), K(1, kBert), M(1, kBert));
  return world;
}

TEST(OptimizationAgenda, AMapIsOptimisedAfterItWasWelded) {
  const SmallWorld world = TwoMaps();
  OptimizationAgenda agenda({});
  agenda.Update(world.atlas);
  EXPECT_FALSE(agenda.Start(world.atlas));
  EXPECT_FALSE(agenda.MapWelded(M(1))) << "nothing runs that were to be cancelled";
  EXPECT_EQ(agenda.Start(world.atlas), M(1));
  EXPECT_FALSE(agenda.Start(world.atlas)) << "one at a time";
  agenda.Finish(true);
  agenda.Update(world.atlas);
  EXPECT_FALSE(agenda.Start(world.atlas));
}

TEST(OptimizationAgenda, AWeldCancelsTheOptimisationOfItsMapAndLaunchesItAgain) {
  const SmallWorld world = TwoMaps();
  OptimizationAgenda agenda({});
  agenda.MapWelded(M(1));
  agenda.Start(world.atlas);
  EXPECT_FALSE(agenda.MapWelded(M(1, kBert))) << "another map";
  EXPECT_TRUE(agenda.MapWelded(M(1)));
  agenda.Finish(false);
  EXPECT_EQ(agenda.Start(world.atlas), M(1, kBert)) << "it was due first";
  agenda.Finish(true);
  EXPECT_EQ(agenda.Start(world.atlas), M(1));
}

TEST(OptimizationAgenda, WhenTheMapOfTheRunningOneIsAbsorbedTheSurvivorIsOptimised) {
  SmallWorld world = TwoMaps();
  OptimizationAgenda agenda({});
  agenda.MapWelded(M(1, kBert));
  EXPECT_EQ(agenda.Start(world.atlas), M(1, kBert));
  world.Do(MergeMaps{M(1), M(1, kBert), {}, K(1, kBert), K(1)});
  EXPECT_FALSE(agenda.MapWelded(M(1)));
  EXPECT_TRUE(agenda.MapWelded(M(1, kBert)));
  agenda.Finish(false);
  agenda.Update(world.atlas);
  EXPECT_EQ(agenda.waiting(), 1u) << "both names are one map";
  EXPECT_EQ(agenda.Start(world.atlas), M(1));
}

TEST(OptimizationAgenda, AMapThatWasClosedIsOptimisedOnce) {
  SmallWorld world = TwoMaps();
  OptimizationAgenda agenda({});
  world.Do(CloseMap{M(1)});
  agenda.Update(world.atlas);
  EXPECT_EQ(agenda.Start(world.atlas), M(1));
  agenda.Update(world.atlas);
  agenda.Finish(true);
  agenda.Update(world.atlas);
  EXPECT_FALSE(agenda.Start(world.atlas));
}

TEST(OptimizationAgenda, AWeldedMapThatGrewIsOptimisedAgain) {
  SmallWorld world = TwoMaps();
  world.Do(AddLoopEdge{K(3), K(1), {}});
  OptimizationAgenda agenda({.growth = 0.5});
  agenda.Update(world.atlas);
  ASSERT_EQ(agenda.Start(world.atlas), M(1)) << "also after a restart, when nobody remembers the last one";
  agenda.Finish(true);
  world.Child(K(4), K(3), M(1));
  agenda.Update(world.atlas);
  EXPECT_FALSE(agenda.Start(world.atlas));
  world.Child(K(5), K(4), M(1));
  agenda.Update(world.atlas);
  EXPECT_EQ(agenda.Start(world.atlas), M(1));
}

TEST(OptimizationAgenda, AWeldedMapIsOptimisedAgainWhenASessionInItClosedItsOwnAndItGrewAtAll) {
  SmallWorld world = TwoMaps();
  world.Do(MergeMaps{M(1), M(1, kBert), {}, K(1, kBert), K(1)});
  world.Do(AddLoopEdge{K(3), K(1), {}});
  OptimizationAgenda agenda({});
  agenda.Update(world.atlas);
  ASSERT_EQ(agenda.Start(world.atlas), M(1));
  agenda.SessionClosedMap(world.atlas, kBert);
  agenda.Finish(true);
  EXPECT_FALSE(agenda.Start(world.atlas)) << "all of it is in the one that ran";
  world.Child(K(3, kBert), K(2, kBert), M(1, kBert));
  agenda.Update(world.atlas);
  EXPECT_FALSE(agenda.Start(world.atlas)) << "too little for one by itself";
  agenda.SessionClosedMap(world.atlas, kBert);
  EXPECT_EQ(agenda.Start(world.atlas), M(1));
}

TEST(OptimizationAgenda, ASessionThatClosesAMapNobodySawFromElsewhereChangesNothing) {
  const SmallWorld world = TwoMaps();
  OptimizationAgenda agenda({});
  agenda.SessionClosedMap(world.atlas, kBert);
  EXPECT_FALSE(agenda.Start(world.atlas));
}

TEST(OptimizationAgenda, WhereASessionEndsItsMapIsAdjustedUntilItIsSettled) {
  SmallWorld world = TwoMaps();
  world.Do(CloseMap{M(1)});
  OptimizationAgenda agenda({.settled_share = 0.5, .closing_rounds = 2});
  agenda.SessionClosedMap(world.atlas, kAnna);
  agenda.Update(world.atlas);
  // Two of its three landmarks were duplicates.
  for (int round = 0; round < 3; ++round) {
    EXPECT_EQ(agenda.Start(world.atlas), M(1)) << round;
    agenda.Finish(true, 2);
    agenda.Update(world.atlas);
  }
  EXPECT_FALSE(agenda.Start(world.atlas)) << "twice more at most";
  agenda.SessionClosedMap(world.atlas, kAnna);
  agenda.MapWelded(M(1));
  EXPECT_EQ(agenda.Start(world.atlas), M(1));
  agenda.Finish(true, 1);
  EXPECT_FALSE(agenda.Start(world.atlas)) << "one of three: it is settled";
}

TEST(OptimizationAgenda, AMapInWhichNoSessionEndsWaitsForTheNextReasonHoweverManyDuplicatesThereWere) {
  const SmallWorld world = TwoMaps();
  OptimizationAgenda agenda({.settled_share = 0.0});
  agenda.MapWelded(M(1));
  EXPECT_EQ(agenda.Start(world.atlas), M(1));
  agenda.Finish(true, 3);
  agenda.Update(world.atlas);
  EXPECT_FALSE(agenda.Start(world.atlas));
}

TEST(OptimizationAgenda, OneThatWasCancelledAgainAndAgainIsLetFinish) {
  const SmallWorld world = TwoMaps();
  OptimizationAgenda agenda({.patience = 2});
  agenda.MapWelded(M(1));
  for (int i = 0; i < 2; ++i) {
    EXPECT_FALSE(agenda.HoldsLoops(M(1)));
    ASSERT_EQ(agenda.Start(world.atlas), M(1));
    EXPECT_TRUE(agenda.MapWelded(M(1)));
    agenda.Finish(false);
  }
  EXPECT_TRUE(agenda.HoldsLoops(M(1)));
  EXPECT_FALSE(agenda.HoldsLoops(M(1, kBert)));
  ASSERT_EQ(agenda.Start(world.atlas), M(1));
  EXPECT_TRUE(agenda.HoldsLoops(M(1)));
  agenda.Finish(true);
  EXPECT_FALSE(agenda.HoldsLoops(M(1)));
}

TEST(OptimizationAgenda, AResultThatCameBeforeItsCancellationCountsAndTheMapIsStillDue) {
  const SmallWorld world = TwoMaps();
  OptimizationAgenda agenda({});
  agenda.MapWelded(M(1));
  agenda.Start(world.atlas);
  agenda.MapWelded(M(1));
  agenda.Finish(true);
  EXPECT_EQ(agenda.Start(world.atlas), M(1));
}

}  // namespace
}  // namespace pangaea
