#include <gtest/gtest.h>

#include <random>

#include "common/map/consistency.h"
#include "common/map/map_edit.h"
#include "common/map/spanning_tree.h"
#include "server/optimization/correction.h"
#include "tests/map/random_edits.h"
#include "tests/map/small_world.h"

namespace pangaea {
namespace {

constexpr double kTiny = 1e-9;
constexpr double kQuantised = 4e-6;  // points travel as QuantizePoint has them

double Apart(const Rigid3d& a, const Rigid3d& b) { return (a * b.Inverse()).Log().norm(); }

// The correction that turns and shifts the given keyframes of the small world's map.
Correction Shift(const SmallWorld& world, const std::vector<KeyframeId>& ids, double scale = 1.0) {
  Correction correction{.base = world.atlas, .map = M(1), .keyframes = {}, .landmarks = {}};
  for (const KeyframeId id : ids) {
    const double n = id.counter;
    correction.keyframes.push_back({id, MakePose(0.1 * n, 0.2 * n, 0.3, 0.1) * world.Get(id).camera_from_map, scale});
  }
  return correction;
}

void ApplyAll(const std::vector<MapEdit>& edits, SmallWorld& world) {
  for (const MapEdit& edit : edits) world.Do(edit);
}

Eigen::Vector3d InReference(const SmallWorld& world, LandmarkId id) {
  const Landmark& landmark = world.Get(id);
  return world.Get(landmark.reference).camera_from_map * landmark.point_in_map;
}

Rigid3d FromParent(const SmallWorld& world, KeyframeId id) {
  const Keyframe& keyframe = world.Get(id);
  return keyframe.camera_from_map * world.Get(keyframe.parent).camera_from_map.Inverse();
}

TEST(Rebase, InAWorldThatNobodyEditedEachKeyframeTakesItsCorrectedPose) {
  SmallWorld world = RowOfThree();
  const Rigid3d root = world.Get(K(1)).camera_from_map;
  const Correction correction = Shift(world, {K(2), K(3)});
  ApplyAll(Rebase(correction, world.atlas), world);
  EXPECT_LT(Apart(world.Get(K(2)).camera_from_map, correction.keyframes[0].camera_from_map), kTiny);
  EXPECT_LT(Apart(world.Get(K(3)).camera_from_map, correction.keyframes[1].camera_from_map), kTiny);
  EXPECT_TRUE(SameBits(world.Get(K(1)).camera_from_map, root));
}

TEST(Rebase, LandmarksFollowTheirReferenceKeyframeAndItsScale) {
  SmallWorld world = RowOfThree();
  const Eigen::Vector3d of_second = InReference(world, L(2));
  const Eigen::Vector3d of_root = world.Get(L(1)).point_in_map;
  ApplyAll(Rebase(Shift(world, {K(2), K(3)}, 1.5), world.atlas), world);
  EXPECT_LT((InReference(world, L(2)) - 1.5 * of_second).norm(), kQuantised);
  EXPECT_EQ(world.Get(L(1)).point_in_map, of_root);
}

TEST(Rebase, ACorrectedLandmarkTakesItsPointUnlessItWasEditedSince) {
  SmallWorld world = RowOfThree();
  Correction correction = Shift(world, {K(2), K(3)});
  const Eigen::Vector3d target = world.Get(L(2)).point_in_map + Eigen::Vector3d(0.1, 0.2, 0.3);
  correction.landmarks = {{L(2), target}, {L(3), target}};
  world.Do(MoveLandmarks{{{L(3), {0.5, 0.6, 7.0}}}});
  ApplyAll(Rebase(correction, world.atlas), world);
  EXPECT_LT((world.Get(L(2)).point_in_map - target).norm(), kQuantised);
  EXPECT_LT((InReference(world, L(3)) - Eigen::Vector3d(0.5, 0.6, 7.0)).norm(), kQuantised);
}

TEST(Rebase, AKeyframeEditedSinceKeepsItsPoseRelativeToItsParentScaledAsTheParentIs) {
  SmallWorld world = RowOfThree();
  const Correction correction = Shift(world, {K(2), K(3)}, 2.0);
  const std::pair<KeyframeId, Rigid3d> edited = {K(3), MakePose(0.2, 1.0, 1.0, 1.0) * world.Get(K(3)).camera_from_map};
  world.Do(MoveKeyframesTo(world.atlas, std::span(&edited, 1)));
  const Rigid3d from_parent = FromParent(world, K(3));
  ApplyAll(Rebase(correction, world.atlas), world);
  EXPECT_LT(Apart(world.Get(K(2)).camera_from_map, correction.keyframes[0].camera_from_map), kTiny);
  const Rigid3d scaled(from_parent.rotation(), 2.0 * from_parent.translation());
  EXPECT_LT(Apart(FromParent(world, K(3)), scaled), kTiny);
}

TEST(Rebase, KeyframesNewerThanTheSnapshotFollowTheirParents) {
  SmallWorld world = RowOfThree();
  const Correction correction = Shift(world, {K(2), K(3)}, 0.5);
  world.Child(K(4), K(3), M(1));
  world.Child(K(5), K(4), M(1));
  world.Child(K(6), K(1), M(1));
  const Rigid3d from_parent = FromParent(world, K(5));
  const Rigid3d beside_root = world.Get(K(6)).camera_from_map;
  ApplyAll(Rebase(correction, world.atlas), world);
  EXPECT_LT(Apart(FromParent(world, K(5)), Rigid3d(from_parent.rotation(), 0.5 * from_parent.translation())), kTiny);
  EXPECT_TRUE(SameBits(world.Get(K(6)).camera_from_map, beside_root));
}

TEST(Rebase, WhatVanishedIsSkippedAndOrphansStillTakeTheirCorrectedPose) {
  SmallWorld world = RowOfThree();
  Correction correction = Shift(world, {K(2), K(3)});
  correction.landmarks = {{L(2), {1.0, 2.0, 30.0}}};
  world.Do(RemoveKeyframe{K(2)});
  world.Do(RemoveLandmark{L(2)});
  ApplyAll(Rebase(correction, world.atlas), world);
  ASSERT_EQ(world.Get(K(3)).parent, K(1));
  EXPECT_LT(Apart(world.Get(K(3)).camera_from_map, correction.keyframes[1].camera_from_map), kTiny);
}

TEST(Rebase, WhatAMergeBroughtInFollowsAndTheCorrectionOfAnAbsorbedMapIsDropped) {
  SmallWorld world = RowOfThree();
  world.Root(K(1, kBert), M(1, kBert));
  world.Child(K(2, kBert), K(1, kBert), M(1, kBert));
  const Correction of_survivor = Shift(world, {K(2), K(3)});
  Correction of_absorbed{.base = world.atlas, .map = M(1, kBert), .keyframes = {}, .landmarks = {}};
  of_absorbed.keyframes.push_back({K(1, kBert), MakePose(0.2, 1.0, 2.0, 0.5)});
  world.Do(MergeMaps{M(1), M(1, kBert), Similarity3d(1.3, Eigen::Quaterniond::Identity(), {1.0, 0.0, 0.0}), K(2, kBert),
                     K(3)});
  EXPECT_TRUE(Rebase(of_absorbed, world.atlas).empty());
  const Rigid3d attachment = FromParent(world, K(2, kBert));
  const Rigid3d below = FromParent(world, K(1, kBert));
  ApplyAll(Rebase(of_survivor, world.atlas), world);
  EXPECT_LT(Apart(world.Get(K(3)).camera_from_map, of_survivor.keyframes[1].camera_from_map), kTiny);
  EXPECT_LT(Apart(FromParent(world, K(2, kBert)), attachment), kTiny);
  EXPECT_LT(Apart(FromParent(world, K(1, kBert)), below), kTiny);
}

TEST(Rebase, ACorrectionOfAMapThatIsGoneIsEmpty) {
  SmallWorld world;
  world.Root(K(1), M(1));
  const Correction correction = Shift(world, {K(1)});
  world.Do(RemoveKeyframe{K(1)});
  EXPECT_TRUE(Rebase(correction, world.atlas).empty());
}

// A history at random, and in its midst a snapshot and a correction of one of its larger maps.
struct History {
  explicit History(std::uint64_t seed) : edits(seed), random(seed) {
    for (Run(400); !correction.map.valid(); Run(1)) {
      for (const MapId id : atlas.Maps()) {
        if (atlas.FindMap(id)->keyframes >= 8) correction.map = id;
      }
    }
    correction.base = atlas;
    for (const KeyframeId id : ParentsFirst(atlas, correction.map)) {
      if (random() % 4 != 0) correction.keyframes.push_back({id, Near(*atlas.FindKeyframe(id)), Scale()});
    }
    atlas.ForEachLandmark([&](const Landmark& landmark) {
      if (atlas.MapOf(landmark) != correction.map || random() % 2 == 0) return;
      correction.landmarks.push_back({landmark.id, landmark.point_in_map + Eigen::Vector3d(0.01, 0.02, -0.03)});
    });
  }
  void Run(int count) {
    for (int i = 0; i < count; ++i) (void)Apply(edits.Next(atlas), atlas);
  }
  double Uniform() { return std::uniform_real_distribution<double>(-0.1, 0.1)(random); }
  double Scale() { return 1.0 + Uniform(); }
  Rigid3d Near(const Keyframe& keyframe) {
    Vector6d twist;
    for (double& value : twist) value = Uniform();
    return Rigid3d::Exp(twist) * keyframe.camera_from_map;
  }

  Atlas atlas;
  RandomEdits edits;
  std::mt19937_64 random;
  Correction correction;
};

class RandomRebaseTest : public testing::TestWithParam<int> {};

TEST_P(RandomRebaseTest, AnyInterleavingLeavesTheAtlasConsistentAndIsTakenWhole) {
  History history(static_cast<std::uint64_t>(GetParam()));
  for (int round = 0; round < 20; ++round) {
    Atlas atlas = history.atlas;
    for (const MapEdit& edit : Rebase(history.correction, atlas)) {
      const Status status = Apply(edit, atlas);
      ASSERT_TRUE(status) << KindName(edit) << ": " << status.error().message;
    }
    const auto faults = CheckConsistency(atlas);
    ASSERT_TRUE(faults.empty()) << faults.front();
    history.Run(10);
  }
}

TEST_P(RandomRebaseTest, TheSameSnapshotsGiveTheSameBits) {
  History history(static_cast<std::uint64_t>(GetParam()));
  History again(static_cast<std::uint64_t>(GetParam()));
  history.Run(30);
  again.Run(30);
  EXPECT_EQ(EncodeEdits(Rebase(history.correction, history.atlas)), EncodeEdits(Rebase(again.correction, again.atlas)));
}

TEST_P(RandomRebaseTest, UneditedKeyframesAreExactlyWhereTheCorrectionSaysAndTheOthersWhereTheyWere) {
  History history(static_cast<std::uint64_t>(GetParam()));
  Atlas atlas = history.atlas;
  for (const MapEdit& edit : Rebase(history.correction, atlas)) ASSERT_TRUE(Apply(edit, atlas));
  std::map<KeyframeId, Rigid3d> corrected;
  for (const CorrectedKeyframe& keyframe : history.correction.keyframes) {
    corrected[keyframe.id] = keyframe.camera_from_map;
  }
  history.atlas.ForEachKeyframe([&](const Keyframe& before) {
    const Rigid3d& now = atlas.FindKeyframe(before.id)->camera_from_map;
    const auto found = corrected.find(before.id);
    if (found == corrected.end()) {
      EXPECT_TRUE(SameBits(now, before.camera_from_map));
    } else {
      EXPECT_LT(Apart(now, found->second), kTiny);
    }
  });
  for (const CorrectedLandmark& landmark : history.correction.landmarks) {
    const Landmark& now = *atlas.FindLandmark(landmark.id);
    // No edit can place a point behind its reference camera.
    if ((atlas.FindKeyframe(now.reference)->camera_from_map * landmark.point_in_map).z() <= 0.0) continue;
    EXPECT_LT((now.point_in_map - landmark.point_in_map).norm(), kQuantised);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomRebaseTest, testing::Range(1, 31));

}  // namespace
}  // namespace pangaea
