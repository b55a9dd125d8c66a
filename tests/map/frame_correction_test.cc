#include "common/map/frame_correction.h"

#include <gtest/gtest.h>

#include <map>

#include "common/map/keyframe_codec.h"
#include "common/map/spanning_tree.h"
#include "common/map/trajectory.h"
#include "tests/map/small_world.h"

namespace pangaea {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

// A keyframe at 0 s, one at 10 s that was tracked 1 m beside it, and frames of the way at every second.
struct Way {
  Way() {
    world.Do(AddKeyframe{K(1), M(1), {}, Rigid3d(), MakeData(20)});
    auto data = std::make_shared<KeyframeData>(*MakeData(20, 10 * kSecond));
    data->arrival = {K(1), tracked, 1.0, 0};
    world.Do(AddKeyframe{K(2), M(1), K(1), tracked, data});
    std::vector<TrackedFrame> frames;
    for (int second = 1; second < 10; ++second) {
      frames.push_back({K(1), {second * kSecond, MakePose(0.0, 0.1 * second, 0.0, 0.0)}});
    }
    world.Do(AddFramePoses{frames});
  }
  std::map<std::int64_t, Eigen::Vector3d> Positions() const {
    std::map<std::int64_t, Eigen::Vector3d> positions;
    for (const TrajectoryPose& pose : SessionTrajectory(world.atlas, kAnna)) {
      positions[pose.stamp_ns / kSecond] = pose.map_from_camera.translation();
    }
    return positions;
  }
  void Move(KeyframeId id, const Rigid3d& camera_from_map) {
    world.Do(MoveKeyframesTo(world.atlas, std::vector{std::pair(id, camera_from_map)}));
  }

  const Rigid3d tracked = MakePose(0.0, -1.0, 0.0, 0.0);
  SmallWorld world;
};

void ExpectSame(const std::map<std::int64_t, Eigen::Vector3d>& a, const std::map<std::int64_t, Eigen::Vector3d>& b,
                double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [second, position] : a) EXPECT_LT((position - b.at(second)).norm(), tolerance) << second;
}

TEST(FrameCorrection, WhileNothingIsAdjustedFramesAreWhereTheyWereTracked) {
  const Way way;
  const auto positions = way.Positions();
  EXPECT_EQ(positions.size(), 11U);
  for (const auto& [second, position] : positions) EXPECT_NEAR(position.x(), 0.1 * second, 1e-9) << second;
}

TEST(FrameCorrection, FramesShareWhatBecameOfTheNextKeyframeByTheirTime) {
  Way way;
  way.Move(K(2), MakePose(0.0, -1.0, -0.2, 0.0));
  for (const auto& [second, position] : way.Positions()) {
    EXPECT_NEAR(position.x(), 0.1 * second, 1e-9) << second;
    EXPECT_NEAR(position.y(), 0.02 * second, 1e-9) << second;
  }
}

TEST(FrameCorrection, CullingTheNextKeyframeMovesNoFrame) {
  Way way;
  way.Move(K(2), MakePose(0.01, -1.0, -0.2, 0.1));
  const auto before = way.Positions();
  way.world.Do(RemoveKeyframe{K(2)});
  ExpectSame(way.Positions(), before, 1e-9);
}

TEST(FrameCorrection, AFrameThatBecameAKeyframeLaterIsWhereThatIsAlsoWhenItIsCulled) {
  Way way;
  way.world.Child(K(3), K(2), M(1));
  // Tracked against keyframe 1, child of keyframe 3: when it goes, its frames go there.
  auto data = std::make_shared<KeyframeData>(*MakeData(20, 20 * kSecond));
  data->arrival = {K(1), way.tracked, 1.0, 10 * kSecond};
  way.world.Do(AddKeyframe{K(4), M(1), K(3), way.tracked, data});
  way.world.Do(AddFramePoses{{{K(1), {20 * kSecond, way.tracked.Inverse()}}}});
  const Rigid3d adjusted = MakePose(0.01, -1.0, -0.2, 0.1);
  way.Move(K(4), adjusted);
  const auto before = way.Positions();
  EXPECT_LT((before.at(20) - adjusted.Inverse().translation()).norm(), 1e-12);
  way.world.Do(RemoveKeyframe{K(4)});
  ExpectSame(way.Positions(), before, 1e-9);
}

TEST(FrameCorrection, CullingTheirReferenceMovesNoFrameEither) {
  Way way;
  way.Move(K(2), MakePose(0.01, -1.0, -0.2, 0.1));
  way.world.Child(K(3), K(1), M(1));
  const auto before = way.Positions();
  way.world.Do(RemoveKeyframe{K(1)});
  ExpectSame(way.Positions(), before, 1e-9);
  way.world.Do(RemoveKeyframe{K(2)});
  ExpectSame(way.Positions(), before, 1e-9);
}

TEST(FrameCorrection, LengthsFollowTheScaleOfTheirReference) {
  Way way;
  MoveKeyframes grown = MoveKeyframesTo(
      way.world.atlas, std::vector{std::pair(K(1), Rigid3d()), std::pair(K(2), MakePose(0.0, -2.0, -0.4, 0.0))});
  grown.correction = 7;
  for (MovedKeyframe& moved : grown.keyframes) {
    moved.scale = 2.0;
    moved.reference_scale = {};  // measured from the reference as this very edit leaves it
  }
  way.world.Do(grown);
  for (const auto& [second, position] : way.Positions()) {
    EXPECT_NEAR(position.x(), 0.2 * second, 1e-9) << second;
    EXPECT_NEAR(position.y(), 0.04 * second, 1e-9) << second;
  }
}

TEST(FrameCorrection, WhatWasTrackedBeforeTheWayBeganOrBySomebodyElseStays) {
  Way way;
  way.world.Do(AddFramePoses{{{K(1), {-5 * kSecond, MakePose(0.0, 0.0, 0.0, 3.0)}}}});
  way.Move(K(2), MakePose(0.0, -1.0, -0.2, 0.0));
  EXPECT_EQ(way.Positions().at(-5), Eigen::Vector3d(0.0, 0.0, 3.0));
  const auto correction = FrameCorrection::Of(way.world.Get(K(2)), way.world.atlas);
  ASSERT_TRUE(correction);
  EXPECT_TRUE(correction->Corrects({5 * kSecond, Rigid3d(), kAnna}));
  EXPECT_FALSE(correction->Corrects({5 * kSecond, Rigid3d(), kBert}));
  EXPECT_TRUE(correction->Corrects({10 * kSecond, Rigid3d(), kAnna}));
  EXPECT_FALSE(correction->Corrects({11 * kSecond, Rigid3d(), kAnna}));
  EXPECT_FALSE(FrameCorrection::Of(way.world.Get(K(1)), way.world.atlas)) << "it was not tracked";
}

TEST(FrameCorrection, TravelsWithTheKeyframe) {
  const Way way;
  const KeyframeData& sent = *way.world.Get(K(2)).data;
  ByteWriter writer;
  EncodeKeyframeData(sent, writer);
  ByteReader reader(writer.bytes());
  const auto received = DecodeKeyframeData(reader);
  ASSERT_TRUE(received);
  EXPECT_EQ((*received)->arrival.reference, K(1));
  EXPECT_TRUE(SameBits((*received)->arrival.camera_from_reference, way.tracked));
  EXPECT_EQ((*received)->arrival.reference_scale, 1.0);
  EXPECT_EQ((*received)->arrival.since_ns, 0);
  for (std::size_t size = 0; size < writer.bytes().size(); ++size) {
    ByteReader cut(writer.bytes().first(size));
    EXPECT_FALSE(DecodeKeyframeData(cut)) << size;
  }
}

TEST(FrameCorrection, AnArrivalThatCannotBeIsRefused) {
  Way way;
  const auto refuse = [&](const TrackedArrival& arrival) {
    auto data = std::make_shared<KeyframeData>(*MakeData(20, 20 * kSecond));
    data->arrival = arrival;
    way.world.Refuse(AddKeyframe{K(3), M(1), K(2), Rigid3d(), data}, ErrorCode::kInvalidArgument);
  };
  refuse({K(2), way.tracked, 1.0, 20 * kSecond});
  refuse({K(2), way.tracked, -1.0, 0});
  refuse({K(2), MakePose(0.0, std::nan(""), 0.0, 0.0), 1.0, 0});
  refuse({K(2), MakePose(0.0, 1e30, 0.0, 0.0), 1.0, 0});
}

}  // namespace
}  // namespace pangaea
