#include <gtest/gtest.h>

#include "common/map/covisibility.h"
#include "common/map/digest.h"
#include "common/map/spanning_tree.h"
#include "common/map/trajectory.h"
#include "tests/map/small_world.h"

namespace pangaea {
namespace {

TEST(Covisibility, NeighboursComeByWeightThenById) {
  SmallWorld world = RowOfThree();
  EXPECT_EQ(CovisibleKeyframes(world.atlas, K(2)), (std::vector<Covisibility>{{K(1), 1}, {K(3), 1}}));
  world.Observe(L(3), K(2), 8);
  EXPECT_EQ(CovisibleKeyframes(world.atlas, K(2)), (std::vector<Covisibility>{{K(3), 2}, {K(1), 1}}));
  EXPECT_EQ(CovisibleKeyframes(world.atlas, K(2), 2), (std::vector<Covisibility>{{K(3), 2}}));
  EXPECT_TRUE(CovisibleKeyframes(world.atlas, K(9)).empty());
}

TEST(Covisibility, AWindowGrowsRingByRingUpToItsSize) {
  const SmallWorld world = RowOfThree();
  EXPECT_EQ(GrowWindow(world.atlas, K(1), 9), (std::vector<KeyframeId>{K(1), K(2), K(3)}));
  EXPECT_EQ(GrowWindow(world.atlas, K(1), 2), (std::vector<KeyframeId>{K(1), K(2)}));
  EXPECT_TRUE(GrowWindow(world.atlas, K(1), 0).empty());
  EXPECT_TRUE(GrowWindow(world.atlas, K(9), 3).empty());
}

TEST(SpanningTree, ParentsComeFirst) {
  SmallWorld world = RowOfThree();
  world.Child(K(4), K(1), M(1));
  EXPECT_EQ(ParentsFirst(world.atlas, M(1)), (std::vector<KeyframeId>{K(1), K(2), K(4), K(3)}));
  const std::vector<KeyframeId> some = {K(3), K(9), K(4), K(1), K(3)};
  EXPECT_EQ(ParentsFirst(world.atlas, some), (std::vector<KeyframeId>{K(1), K(4), K(3)}));
  EXPECT_EQ(TreeDepth(world.atlas, K(3)), 2u);
  EXPECT_TRUE(IsAncestorOrSelf(world.atlas, K(2), K(3)));
  EXPECT_FALSE(IsAncestorOrSelf(world.atlas, K(4), K(3)));
}

TEST(SpanningTree, AMoveTakesKeyframesWhereTheyShouldBe) {
  SmallWorld world = RowOfThree();
  const std::vector<std::pair<KeyframeId, Rigid3d>> wanted = {{K(3), MakePose(0.7, 1.0, 2.0, 3.0)},
                                                              {K(9), MakePose(0.1, 0.0, 0.0, 0.0)},
                                                              {K(2), MakePose(-0.4, 0.0, 5.0, 1.0)}};
  const MoveKeyframes edit = MoveKeyframesTo(world.atlas, wanted);
  ASSERT_EQ(edit.keyframes.size(), 2u);
  EXPECT_EQ(edit.keyframes[0].id, K(2));
  world.Do(edit);
  for (const std::size_t i : {0, 2}) {
    const Rigid3d& pose = world.Get(wanted[i].first).camera_from_map;
    EXPECT_LT((pose.Matrix() - wanted[i].second.Matrix()).norm(), 1e-12);
  }
}

TEST(SpanningTree, AMoveTakesLandmarksWhereTheyShouldBe) {
  SmallWorld world = RowOfThree();
  const Eigen::Vector3d wanted = world.Get(L(2)).point_in_map + Eigen::Vector3d(0.1, 0.2, 0.3);
  const Eigen::Vector3d behind = world.Get(K(1)).camera_from_map.Inverse() * Eigen::Vector3d(0.0, 0.0, -1.0);
  const std::vector<std::pair<LandmarkId, Eigen::Vector3d>> moves = {{L(2), wanted}, {L(9), wanted}, {L(1), behind}};
  const MoveLandmarks edit = MoveLandmarksTo(world.atlas, moves);
  ASSERT_EQ(edit.landmarks.size(), 1u);
  world.Do(edit);
  EXPECT_LT((world.Get(L(2)).point_in_map - wanted).norm(), 1e-6);  // QuantizePoint
}

TEST(Digest, ItDoesNotDependOnTheHistory) {
  SmallWorld longer = RowOfThree();
  longer.Add(L(9), K(1), 8);
  longer.Child(K(4), K(3), M(1));
  longer.Do(RemoveKeyframe{K(4)});
  longer.Do(FuseLandmarks{L(1), L(9)});
  EXPECT_EQ(Digest(longer.atlas), Digest(RowOfThree().atlas));
}

TEST(Digest, ItChangesWithAMillimetreOrAnObservation) {
  const std::uint64_t digest = Digest(RowOfThree().atlas);
  SmallWorld moved = RowOfThree();
  moved.Do(MoveLandmarks{{{L(2), {0.2, -0.2, 4.001}}}});
  EXPECT_NE(Digest(moved.atlas), digest);
  SmallWorld observed = RowOfThree();
  observed.Observe(L(3), K(1), 8);
  EXPECT_NE(Digest(observed.atlas), digest);
  SmallWorld turned = RowOfThree();
  turned.Do(MoveKeyframes{{{K(3), MakePose(0.051, 0.5, 0.0, 0.01)}}});
  EXPECT_NE(Digest(turned.atlas), digest);
}

TEST(Digest, MapsAndSessionsHaveTheirOwn) {
  SmallWorld world = RowOfThree();
  const std::uint64_t anna = DigestOfSession(world.atlas, kAnna);
  EXPECT_EQ(Digest(world.atlas, M(1)), Digest(world.atlas));
  world.Root(K(1, kBert), M(1, kBert));
  EXPECT_EQ(DigestOfSession(world.atlas, kAnna), anna);
  EXPECT_NE(DigestOfSession(world.atlas, kBert), anna);
  EXPECT_NE(Digest(world.atlas, M(1)), Digest(world.atlas));
  EXPECT_NE(Digest(world.atlas, M(1, kBert)), Digest(world.atlas, M(1)));
}

TEST(Trajectory, FramesAndKeyframesComeInTheirOrderAndMoveWithTheMap) {
  SmallWorld world = RowOfThree();  // keyframes at 1000, 2000 and 3000
  const Rigid3d reference_from_frame = MakePose(0.1, 0.0, 0.1, 0.2);
  world.Do(AddFramePoses{{{K(1), {1500, reference_from_frame}}, {K(2), {3000, reference_from_frame}}}});
  world.Do(MoveKeyframes{{{K(1), MakePose(0.0, 0.0, 0.0, 7.0)}}});
  world.Do(RemoveKeyframe{K(2)});
  world.Root(K(9), M(2));
  const auto trajectory = SessionTrajectory(world.atlas, kAnna);
  std::vector<std::int64_t> stamps;
  for (const TrajectoryPose& pose : trajectory) stamps.push_back(pose.stamp_ns);
  EXPECT_EQ(stamps, (std::vector<std::int64_t>{1000, 1500, 2000, 3000, 9000}));
  const Rigid3d expected = MakePose(0.0, 0.0, 0.0, -7.0) * reference_from_frame;
  EXPECT_LT((trajectory[1].map_from_camera.Matrix() - expected.Matrix()).norm(), 1e-12);
  EXPECT_EQ(trajectory.back().map, M(2));
  EXPECT_EQ(SessionTrajectory(world.atlas, kAnna, M(1)).size(), 4u);
  EXPECT_TRUE(SessionTrajectory(world.atlas, kBert).empty());
}

TEST(Trajectory, WhatIsAFrameAndAKeyframeIsWhereTheKeyframeIs) {
  SmallWorld world = RowOfThree();
  world.Do(AddFramePoses{{{K(1), {3000, MakePose(0.1, 0.0, 0.1, 0.2)}}}});  // of which keyframe 3 was made later
  const auto trajectory = SessionTrajectory(world.atlas, kAnna);
  ASSERT_EQ(trajectory.size(), 3u);
  EXPECT_EQ(trajectory.back().map_from_camera.translation(),
            world.atlas.FindKeyframe(K(3))->camera_from_map.Inverse().translation());
}

}  // namespace
}  // namespace pangaea
