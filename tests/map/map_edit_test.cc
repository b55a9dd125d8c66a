#include "common/map/map_edit.h"

#include <gtest/gtest.h>

#include "tests/map/small_world.h"

namespace pangaea {
namespace {

using Edges = std::vector<Covisibility>;

TEST(MapEdit, ARootMakesItsMap) {
  SmallWorld world;
  world.Root(K(1), M(1));
  ASSERT_NE(world.atlas.FindMap(M(1)), nullptr);
  EXPECT_EQ(world.atlas.FindMap(M(1))->root, K(1));
  EXPECT_EQ(world.atlas.FindMap(M(1))->keyframes, 1u);
  EXPECT_TRUE(SameBits(world.Get(K(1)).camera_from_map, MakePose(0.3, 1.0, 2.0, 3.0)));
}

TEST(MapEdit, ObservationsMakeCovisibility) {
  const SmallWorld world = RowOfThree();
  EXPECT_EQ(world.Get(K(1)).covisible, (Edges{{K(2), 1}}));
  EXPECT_EQ(world.Get(K(2)).covisible, (Edges{{K(1), 1}, {K(3), 1}}));
  EXPECT_EQ(world.Get(K(2)).landmarks[1], L(1));
  EXPECT_EQ(world.atlas.FindMap(M(1))->landmarks, 3u);
}

TEST(MapEdit, RemovingTheLastObservationRemovesTheLandmark) {
  SmallWorld world = RowOfThree();
  world.Do(RemoveObservation{L(3), K(3)});
  EXPECT_EQ(world.atlas.FindLandmark(L(3)), nullptr);
  EXPECT_FALSE(world.atlas.Resolve(L(3)).valid());
  EXPECT_EQ(world.atlas.landmark_count(), 2u);
}

TEST(MapEdit, RemovingTheReferencesObservationHandsTheReferenceOn) {
  SmallWorld world = RowOfThree();
  const Eigen::Vector3d point_in_map = world.Get(L(1)).point_in_map;
  world.Do(RemoveObservation{L(1), K(1)});
  EXPECT_EQ(world.Get(L(1)).reference, K(2));
  EXPECT_EQ(world.Get(L(1)).point_in_map, point_in_map);
}

TEST(MapEdit, MovingAKeyframeLeavesTheOthersAndTheLandmarksWhereTheyAre) {
  SmallWorld world = RowOfThree();
  const SmallWorld before = world;
  world.Do(MoveKeyframes{{{K(2), MakePose(0.2, 1.0, 0.0, 0.0)}}});
  EXPECT_TRUE(
      SameBits(world.Get(K(2)).camera_from_map, MakePose(0.2, 1.0, 0.0, 0.0) * before.Get(K(1)).camera_from_map));
  EXPECT_TRUE(SameBits(world.Get(K(3)).camera_from_map, before.Get(K(3)).camera_from_map));
  EXPECT_EQ(world.Get(L(2)).point_in_map, before.Get(L(2)).point_in_map);
}

TEST(MapEdit, ListedKeyframesMoveInTurnEachAgainstItsParentsNewPose) {
  SmallWorld world = RowOfThree();
  const Rigid3d step = MakePose(0.2, 1.0, 0.0, 0.0);
  world.Do(MoveKeyframes{{{K(1), MakePose(0.0, 9.0, 0.0, 0.0)}, {K(2), step}, {K(3), step}}});
  EXPECT_TRUE(SameBits(world.Get(K(1)).camera_from_map, MakePose(0.0, 9.0, 0.0, 0.0)));
  EXPECT_TRUE(SameBits(world.Get(K(3)).camera_from_map, step * world.Get(K(2)).camera_from_map));
}

TEST(MapEdit, AMoveAgainstAReferenceMeansTheSameInAnotherTree) {
  SmallWorld world = RowOfThree();
  const Rigid3d step = MakePose(0.2, 1.0, 0.0, 0.0);
  world.Do(MoveKeyframes{{{K(3), step, K(1)}}});
  EXPECT_TRUE(SameBits(world.Get(K(3)).camera_from_map, step * world.Get(K(1)).camera_from_map));
}

TEST(MapEdit, OnceCorrectedAKeyframeIsMovedByCorrectionsAlone) {
  SmallWorld world = RowOfThree();
  const Rigid3d step = MakePose(0.2, 1.0, 0.0, 0.0);
  world.Do(MoveKeyframes{{{K(2), step}}, 7});
  EXPECT_EQ(world.Get(K(2)).corrected_at, 7u);
  const Rigid3d corrected = world.Get(K(2)).camera_from_map;
  world.Do(MoveKeyframes{{{K(2), MakePose(0.0, 3.0, 0.0, 0.0)}}});  // its agent's, late
  EXPECT_TRUE(SameBits(world.Get(K(2)).camera_from_map, corrected));
  world.Do(MoveKeyframes{{{K(2), MakePose(0.0, 3.0, 0.0, 0.0)}}, 8});
  EXPECT_EQ(world.Get(K(2)).corrected_at, 8u);
  EXPECT_FALSE(SameBits(world.Get(K(2)).camera_from_map, corrected));
}

TEST(MapEdit, WhatOnlyComesAlongWithACorrectionRemainsItsAgentsToMove) {
  SmallWorld world = RowOfThree();
  MoveKeyframes along{{{K(3), MakePose(0.1, 1, 2, 3), K(2), {}, 2.0, false}}, 7};
  world.Do(along);
  EXPECT_EQ(world.Get(K(3)).corrected_at, 0U);
  EXPECT_EQ(world.Get(K(3)).scale, 2.0);
  world.Do(MoveKeyframes{{{K(3), MakePose(0.2, 0, 0, 1), K(2)}}});
  EXPECT_TRUE(SameBits(world.Get(K(3)).camera_from_map, MakePose(0.2, 0, 0, 1) * world.Get(K(2)).camera_from_map));
}

TEST(MapEdit, LengthsMeasuredBeforeAKeyframeWasScaledAreScaledWhenTheyArrive) {
  SmallWorld world = RowOfThree();
  const Rigid3d same = world.Get(K(3)).camera_from_map * world.Get(K(2)).camera_from_map.Inverse();
  world.Do(MoveKeyframes{{{K(3), same, K(2), {}, 2.0}}, 7});
  EXPECT_EQ(world.Get(K(3)).scale, 2.0);
  world.Do(AddLandmark{L(9), K(3), 9, {0.1, 0.2, 3.0}, {1.0}});
  const Eigen::Vector3d late = world.Get(K(3)).camera_from_map * world.Get(L(9)).point_in_map;
  EXPECT_LT((late - Eigen::Vector3d(0.2, 0.4, 6.0)).norm(), 1e-12);
  world.Do(MoveLandmarks{{{L(9), {0.1, 0.2, 3.0}, K(3), {2.0}}}});  // measured after the correction
  const Eigen::Vector3d moved = world.Get(K(3)).camera_from_map * world.Get(L(9)).point_in_map;
  EXPECT_LT((moved - Eigen::Vector3d(0.1, 0.2, 3.0)).norm(), 1e-12);
  const Rigid3d step = MakePose(0.2, 1.0, 0.0, 0.0);
  world.Do(AddKeyframe{K(4), M(1), K(3), step, MakeData(20, 4000), {1.0}});
  const Rigid3d arrived = world.Get(K(4)).camera_from_map * world.Get(K(3)).camera_from_map.Inverse();
  EXPECT_LT((arrived.translation() - 2.0 * step.translation()).norm(), 1e-12);
  EXPECT_EQ(world.Get(K(4)).scale, 2.0);
}

TEST(MapEdit, ALandmarkMovesAgainstTheReferenceThatIsSaid) {
  SmallWorld world = RowOfThree();
  world.Do(MoveLandmarks{{{L(2), {1.0, 2.0, 3.0}, K(3)}}});  // its own reference is keyframe 2
  const Eigen::Vector3d point_in_said = world.Get(K(3)).camera_from_map * world.Get(L(2)).point_in_map;
  EXPECT_LT((point_in_said - Eigen::Vector3d(1.0, 2.0, 3.0)).norm(), 1e-12);
}

TEST(MapEdit, AnAgentMayNotPassOffItsMovesAsCorrections) {
  EXPECT_FALSE(TouchesOnly(MoveKeyframes{{{K(1), {}}}, 3}, kAnna));
  EXPECT_FALSE(TouchesOnly(MergeMaps{M(1), M(2), {}, K(2), K(1), 3}, kAnna));
}

TEST(MapEdit, ALandmarkMovesInItsReferencesFrame) {
  SmallWorld world = RowOfThree();
  world.Do(MoveLandmarks{{{L(2), {1.0, 2.0, 3.0}}}});
  const Eigen::Vector3d point_in_reference = world.Get(K(2)).camera_from_map * world.Get(L(2)).point_in_map;
  EXPECT_LT((point_in_reference - Eigen::Vector3d(1.0, 2.0, 3.0)).norm(), 1e-12);
}

TEST(MapEdit, FusingMovesObservationsAndForwardsTheId) {
  SmallWorld world = RowOfThree();
  world.Do(FuseLandmarks{L(1), L(3)});
  EXPECT_EQ(world.atlas.Resolve(L(3)), L(1));
  EXPECT_EQ(world.Get(L(1)).observations.size(), 3u);
  EXPECT_EQ(world.Get(K(3)).landmarks[3], L(1));
  EXPECT_EQ(world.Get(K(3)).covisible, (Edges{{K(1), 1}, {K(2), 2}}));
}

TEST(MapEdit, WhereOneKeyframeSeesBothTheKeptOnesKeypointStaysAndTheOtherIsFree) {
  SmallWorld world = RowOfThree();
  world.Do(FuseLandmarks{L(1), L(2)});  // keyframe 2 sees both
  EXPECT_EQ(world.Get(K(2)).landmarks[1], L(1));
  EXPECT_FALSE(world.Get(K(2)).landmarks[2].valid());
  EXPECT_EQ(world.Get(K(3)).landmarks[2], L(1));
}

TEST(MapEdit, ALateObservationOfAFusedLandmarkGoesToItsAbsorber) {
  SmallWorld world = RowOfThree();
  world.Do(FuseLandmarks{L(3), L(1)});
  world.Do(FuseLandmarks{L(2), L(3)});
  world.Child(K(4), K(3), M(1));
  world.Observe(L(1), K(4), 7);
  EXPECT_EQ(world.Get(K(4)).landmarks[7], L(2));
  world.Observe(L(3), K(4), 8);  // the absorber is seen from there already
  EXPECT_FALSE(world.Get(K(4)).landmarks[8].valid());
  world.Do(RemoveObservation{L(1), K(4)});
  EXPECT_FALSE(world.Get(K(4)).landmarks[7].valid());
}

TEST(MapEdit, MovingOrRemovingAFusedLandmarkLeavesItsAbsorberAlone) {
  SmallWorld world = RowOfThree();
  world.Do(FuseLandmarks{L(1), L(3)});
  const Eigen::Vector3d point_in_map = world.Get(L(1)).point_in_map;
  world.Do(MoveLandmarks{{{L(3), {1.0, 2.0, 3.0}}}});
  world.Do(RemoveLandmark{L(3)});
  EXPECT_EQ(world.Get(L(1)).point_in_map, point_in_map);
}

TEST(MapEdit, ChildrenOfACulledKeyframeGoToItsParent) {
  SmallWorld world = RowOfThree();
  const Rigid3d camera_from_map = world.Get(K(3)).camera_from_map;
  world.Do(RemoveKeyframe{K(2)});
  EXPECT_EQ(world.Get(K(3)).parent, K(1));
  EXPECT_EQ(world.Get(K(1)).children, std::vector<KeyframeId>{K(3)});
  EXPECT_TRUE(SameBits(world.Get(K(3)).camera_from_map, camera_from_map));
  EXPECT_EQ(world.atlas.Resolve(K(2)), K(1));
  EXPECT_EQ(world.Get(L(2)).reference, K(3));
}

TEST(MapEdit, MovingACulledKeyframeLeavesTheMapUnchanged) {
  SmallWorld world = RowOfThree();
  world.Do(RemoveKeyframe{K(3)});
  const Rigid3d camera_from_map = world.Get(K(2)).camera_from_map;
  world.Do(MoveKeyframes{{{K(3), MakePose(0.2, 1.0, 0.0, 0.0)}}});
  EXPECT_EQ(world.atlas.FindKeyframe(K(3)), nullptr);
  EXPECT_TRUE(SameBits(world.Get(K(2)).camera_from_map, camera_from_map));
}

TEST(MapEdit, FramesOfACulledKeyframeStayWhereTheyAreEarlyOrLate) {
  SmallWorld world = RowOfThree();
  const Rigid3d reference_from_frame = MakePose(0.1, 0.0, 0.1, 0.2);
  const Rigid3d map_from_frame = world.Get(K(3)).camera_from_map.Inverse() * reference_from_frame;
  world.Do(AddFramePoses{{{K(3), {3001, reference_from_frame}}}});
  world.Do(RemoveKeyframe{K(3)});
  world.Do(RemoveKeyframe{K(2)});
  world.Do(AddFramePoses{{{K(3), {3002, reference_from_frame}}}});
  const auto& frames = *world.Get(K(1)).frames;
  ASSERT_EQ(frames.size(), 4u);  // those of the two culled keyframes themselves, and the two
  EXPECT_EQ(frames[0].stamp_ns, 2000);
  EXPECT_EQ(frames[1].stamp_ns, 3000);
  for (const FramePose& frame : {frames[2], frames[3]}) {
    const Rigid3d moved = world.Get(K(1)).camera_from_map.Inverse() * frame.reference_from_frame;
    EXPECT_LT((moved.Matrix() - map_from_frame.Matrix()).norm(), 1e-12);
    EXPECT_EQ(frame.session, kAnna);
  }
}

TEST(MapEdit, LateObservationsAndLandmarksOfCulledKeyframesAreDropped) {
  SmallWorld world = RowOfThree();
  world.Do(RemoveKeyframe{K(3)});
  world.Observe(L(1), K(3), 9);
  EXPECT_EQ(world.Get(L(1)).observations.size(), 2u);
  world.Add(L(4), K(3), 5);
  EXPECT_EQ(world.atlas.FindLandmark(L(4)), nullptr);
  world.Observe(L(4), K(2), 5);  // what is gone can be referred to, and stays gone
  EXPECT_EQ(world.atlas.FindLandmark(L(4)), nullptr);
}

TEST(MapEdit, WhatArrivesAtAKeypointThatShowsALandmarkByNowIsDroppedOrIsThatLandmark) {
  SmallWorld world = RowOfThree();
  world.Do(AddObservation{L(1), K(3), 3});  // shows landmark 3
  EXPECT_EQ(world.Get(K(3)).landmarks[3], L(3));
  EXPECT_EQ(world.Get(L(1)).observations.size(), 2U);
  world.Do(AddObservation{L(1), K(2), 9});  // seen from there at another keypoint
  EXPECT_FALSE(world.Get(K(2)).landmarks[9].valid());
  world.Do(AddLandmark{L(9), K(1), 1, {0, 0, 1}});  // shows landmark 1
  EXPECT_EQ(world.atlas.FindLandmark(L(9)), nullptr);
  EXPECT_EQ(world.atlas.Resolve(L(9)), L(1));
  world.Do(AddObservation{L(9), K(3), 9});  // late, and to the one that it is
  EXPECT_EQ(world.Get(K(3)).landmarks[9], L(1));
}

TEST(MapEdit, ALateChildOfACulledKeyframeHangsBelowItsAncestor) {
  SmallWorld world = RowOfThree();
  const Rigid3d culled_from_map = world.Get(K(3)).camera_from_map;
  world.Do(RemoveKeyframe{K(3)});
  world.Child(K(4), K(3), M(1));
  EXPECT_EQ(world.Get(K(4)).parent, K(2));
  const Rigid3d expected = MakePose(0.05, 0.5, 0.0, 0.01) * culled_from_map;
  EXPECT_LT((world.Get(K(4)).camera_from_map.Matrix() - expected.Matrix()).norm(), 1e-12);
}

TEST(MapEdit, TheFirstChildOfACulledRootBecomesTheRoot) {
  SmallWorld world = RowOfThree();
  world.Child(K(4), K(1), M(1));
  const Rigid3d root_from_map = world.Get(K(1)).camera_from_map;
  world.Do(RemoveKeyframe{K(1)});
  EXPECT_EQ(world.atlas.FindMap(M(1))->root, K(2));
  EXPECT_FALSE(world.Get(K(2)).parent.valid());
  EXPECT_EQ(world.Get(K(4)).parent, K(2));
  const auto resolved = world.atlas.ResolvePose(K(1));
  ASSERT_TRUE(resolved);
  EXPECT_EQ(resolved->keyframe->id, K(2));
  const Rigid3d would_be = resolved->keyframe_from_asked.Inverse() * resolved->keyframe->camera_from_map;
  EXPECT_LT((would_be.Matrix() - root_from_map.Matrix()).norm(), 1e-12);
}

TEST(MapEdit, TheLastKeyframeOfAMapTakesTheMapWithIt) {
  SmallWorld world = RowOfThree();
  for (const std::uint32_t counter : {2, 3, 1}) world.Do(RemoveKeyframe{K(counter)});
  EXPECT_EQ(world.atlas.FindMap(M(1)), nullptr);
  EXPECT_EQ(world.atlas.landmark_count(), 0u);
  EXPECT_FALSE(world.atlas.Resolve(K(3)).valid());
  world.Do(AddFramePoses{{{K(3), {1, Rigid3d()}}}});  // late, and for nothing
}

TEST(MapEdit, AFrameOfAKnownStampReplacesTheOld) {
  SmallWorld world = RowOfThree();
  world.Do(AddFramePoses{{{K(1), {5, Rigid3d()}}, {K(1), {9, Rigid3d()}}}});
  world.Do(AddFramePoses{{{K(1), {5, MakePose(0.0, 1.0, 0.0, 0.0)}}, {K(1), {7, Rigid3d()}}}});
  const auto& frames = *world.Get(K(1)).frames;
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].reference_from_frame.translation().x(), 1.0);
  EXPECT_EQ(frames[1].stamp_ns, 7);
}

TEST(MapEdit, ALoopEdgeFollowsACulledKeyframeToItsParent) {
  SmallWorld world = RowOfThree();
  const Rigid3d from_3_to_1 = world.Get(K(1)).camera_from_map * world.Get(K(3)).camera_from_map.Inverse();
  const Rigid3d from_2_to_1 = world.Get(K(1)).camera_from_map * world.Get(K(2)).camera_from_map.Inverse();
  world.Do(AddLoopEdge{K(3), K(1), Similarity3d(from_3_to_1)});
  world.Do(RemoveKeyframe{K(3)});
  ASSERT_EQ(world.atlas.loop_edges().size(), 1u);
  const LoopEdge& edge = world.atlas.loop_edges().front();
  EXPECT_EQ(edge.from, K(2));
  EXPECT_LT((edge.to_from_from.translation() - from_2_to_1.translation()).norm(), 1e-12);
  world.Do(AddLoopEdge{K(1), K(3), Similarity3d(from_3_to_1.Inverse())});
  EXPECT_EQ(world.atlas.loop_edges().back().to, K(2));
  world.Do(RemoveKeyframe{K(2)});
  EXPECT_TRUE(world.atlas.loop_edges().empty());
}

// Anna's row of three and Bert's keyframes 1 - 2 - 3 with one landmark and a culled fourth.
SmallWorld TwoMaps() {
  SmallWorld world = RowOfThree();
  world.Root(K(1, kBert), M(1, kBert));
  for (const std::uint32_t counter : {2U, 3U, 4U}) {
    world.Child(K(counter, kBert), K(counter - 1, kBert), M(1, kBert));
  }
  world.Add(L(1, kBert), K(2, kBert), 4);
  world.Observe(L(1, kBert), K(1, kBert), 4);
  world.Do(AddFramePoses{{{K(2, kBert), {2001, MakePose(0.1, 1.0, 0.0, 0.0)}}}});
  world.Do(RemoveKeyframe{K(4, kBert)});
  world.Do(AddLoopEdge{K(1, kBert), K(3, kBert), Similarity3d(MakePose(0.1, 1.0, 0.0, 0.0))});
  return world;
}

const MergeMaps kMerge{M(1), M(1, kBert), Similarity3d(2.0, ExpSo3({0.1, 0.2, 0.3}), {4.0, 5.0, 6.0}), K(3, kBert),
                       K(2)};

TEST(MapEdit, MergingLeavesOneMapWithOneTree) {
  SmallWorld world = TwoMaps();
  world.Do(kMerge);
  EXPECT_EQ(world.atlas.Maps(), std::vector<MapId>{M(1)});
  EXPECT_EQ(world.atlas.Resolve(M(1, kBert)), M(1));
  EXPECT_EQ(world.atlas.FindMap(M(1))->keyframes, 6u);
  EXPECT_EQ(world.atlas.FindMap(M(1))->landmarks, 4u);
  EXPECT_EQ(world.Get(K(3, kBert)).parent, K(2));
  EXPECT_EQ(world.Get(K(2, kBert)).parent, K(3, kBert));
  EXPECT_EQ(world.Get(K(1, kBert)).parent, K(2, kBert));
  EXPECT_EQ(world.Get(K(1, kBert)).map, M(1));
}

TEST(MapEdit, MergingKeepsWhatTheCamerasSeeAndScalesLengths) {
  SmallWorld world = TwoMaps();
  const SmallWorld before = world;
  world.Do(kMerge);
  const KeyframeId id = K(2, kBert);
  const Eigen::Vector3d seen = before.Get(id).camera_from_map * before.Get(L(1, kBert)).point_in_map;
  EXPECT_LT((world.Get(id).camera_from_map * world.Get(L(1, kBert)).point_in_map - 2.0 * seen).norm(), 1e-12);
  const auto scaled = [](const Rigid3d& now, const Rigid3d& then) {
    return (now.translation() - 2.0 * then.translation()).norm() < 1e-12;
  };
  EXPECT_TRUE(
      scaled(world.Get(id).frames->front().reference_from_frame, before.Get(id).frames->front().reference_from_frame));
  EXPECT_TRUE(scaled(world.atlas.FindCulled(K(4, kBert))->parent_from_culled,
                     before.atlas.FindCulled(K(4, kBert))->parent_from_culled));
  EXPECT_EQ(world.atlas.loop_edges().front().to_from_from.translation().x(), 2.0);
  EXPECT_TRUE(SameBits(world.Get(K(2)).camera_from_map, before.Get(K(2)).camera_from_map));
}

TEST(MapEdit, KeyframesOfAMergedMapGoOnInTheSurvivor) {
  SmallWorld world = TwoMaps();
  world.Do(kMerge);
  world.Child(K(5, kBert), K(4, kBert), M(1, kBert));
  EXPECT_EQ(world.Get(K(5, kBert)).map, M(1));
  EXPECT_EQ(world.Get(K(5, kBert)).parent, K(3, kBert));
  world.Do(CloseMap{M(1, kBert)});
  EXPECT_FALSE(world.atlas.FindMap(M(1))->closed);
}

TEST(MapEdit, AfterAMergeFramesOfACulledGuestRemainItsSessions) {
  SmallWorld world = TwoMaps();
  world.Do(kMerge);
  world.Do(RemoveKeyframe{K(3, kBert)});
  ASSERT_TRUE(world.Get(K(2)).frames);
  EXPECT_EQ(world.Get(K(2)).frames->front().session, kBert);
}

TEST(MapEdit, ASnapshotTakenBeforeAnEditIsUnchangedAfterIt) {
  SmallWorld world = TwoMaps();
  const Atlas snapshot = world.atlas;
  const auto before = Fingerprint(snapshot);
  const Landmark* landmark = snapshot.FindLandmark(L(1));
  world.Do(kMerge);
  world.Do(RemoveLandmark{L(1)});
  EXPECT_EQ(Fingerprint(snapshot), before);
  EXPECT_EQ(landmark->observations.size(), 2u);
}

TEST(MapEdit, TwoCopiesOfOneAtlasGoTheirOwnWays) {
  const SmallWorld world = RowOfThree();
  SmallWorld a = world;
  SmallWorld b = world;
  a.Do(RemoveLandmark{L(1)});
  b.Do(RemoveLandmark{L(2)});
  Atlas moved = std::move(a.atlas);
  a.atlas = moved;
  a.Do(RemoveLandmark{L(3)});
  EXPECT_NE(moved.FindLandmark(L(3)), nullptr);
  EXPECT_NE(b.atlas.FindLandmark(L(1)), nullptr);
  EXPECT_EQ(world.atlas.landmark_count(), 3u);
}

TEST(MapEdit, OwnershipIsOfWhatIsChangedNotOfWhatIsReferredTo) {
  EXPECT_TRUE(TouchesOnly(AddObservation{L(1, kBert), K(1), 0}, kAnna));
  EXPECT_FALSE(TouchesOnly(AddObservation{L(1), K(1, kBert), 0}, kAnna));
  EXPECT_TRUE(TouchesOnly(FuseLandmarks{L(1, kBert), L(1)}, kAnna));
  EXPECT_FALSE(TouchesOnly(FuseLandmarks{L(1), L(1, kBert)}, kAnna));
  EXPECT_TRUE(TouchesOnly(AddKeyframe{K(1), M(1, kBert), K(1, kBert), {}, {}}, kAnna));
  EXPECT_FALSE(TouchesOnly(AddKeyframe{K(1), M(1, kBert), {}, {}, {}}, kAnna));
  EXPECT_FALSE(TouchesOnly(AddKeyframe{K(1, kBert), M(1), K(1), {}, {}}, kAnna));
  EXPECT_FALSE(TouchesOnly(MoveKeyframes{{{K(1), {}}, {K(1, kBert), {}}}}, kAnna));
  EXPECT_FALSE(TouchesOnly(kMerge, kAnna));
  EXPECT_TRUE(TouchesOnly(CloseMap{M(1)}, kAnna));
}

}  // namespace
}  // namespace pangaea
