#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/geometry/horn.h"
#include "common/map/consistency.h"
#include "common/map/digest.h"
#include "common/map/forgetting.h"
#include "common/map/map_edit.h"
#include "tests/agent/mapping_walk.h"

namespace pangaea {
namespace {

using testing::CirclePose;
using testing::ExactRig;
using ::testing::IsEmpty;
using testing::kSession;
using testing::kWorlds;
using testing::LookAlong;
using testing::SyntheticWorld;
using testing::SyntheticWorldOptions;
using testing::Walk;

// Beyond the error by noise: what observations that the mapper misses or keeps wrongly may cost.
constexpr double kShareOfNoise = 1.1;
constexpr double kMargin = 0.001;  // metres

TEST(LocalMapper, FirstStereoKeyframeFillsTheMapByItself) {
  Walk walk;
  const KeyframeId root = walk.Visit(CirclePose(0, 60));
  EXPECT_GT(walk.mapper.atlas().landmark_count(), 200U);
  EXPECT_FALSE(walk.mapper.atlas().FindKeyframe(root)->parent.valid());
  EXPECT_THAT(CheckConsistency(walk.mapper.atlas()), IsEmpty());
}

TEST(LocalMapper, KeyframesEndAsNearToTheTruthAsTheNoiseLets) {
  for (std::uint64_t seed = 1; seed <= kWorlds; ++seed) {
    Walk walk(SyntheticWorldOptions{.seed = seed});
    walk.WalkCircle(0, 16, 60);
    const double by_noise = walk.LargestPositionErrorOfNoise();
    EXPECT_LT(by_noise, 0.02) << "seed " << seed;
    EXPECT_LT(walk.LargestPositionError(), kShareOfNoise * by_noise + kMargin) << "seed " << seed;
    EXPECT_THAT(CheckConsistency(walk.mapper.atlas()), IsEmpty());
  }
}

TEST(LocalMapper, OneCornerBecomesOneLandmark) {
  Walk walk;
  walk.WalkCircle(0, 16, 60);
  EXPECT_LT(walk.DuplicateShare(), 0.02);
  EXPECT_LT(walk.WrongObservationShare(), 0.002);
}

TEST(LocalMapper, SeeingTheStartAgainObservesItsLandmarksAndTakesBackTheDrift) {
  Walk blind({}, [] {
    LocalMappingOptions options = ExactRig();
    options.neighbourhood.overlapping = 0;
    options.neighbourhood.second_of_each = 0;
    return options;
  }());
  Walk walk;
  for (int k = 0; k < 64; ++k) {
    blind.Visit(CirclePose(k, 60));
    walk.Visit(CirclePose(k, 60));
  }
  const Keyframe& last = *walk.mapper.atlas().FindKeyframe({kSession, 64});
  const bool sees_the_start = std::any_of(last.covisible.begin(), last.covisible.end(), [](const Covisibility& edge) {
    return edge.keyframe.counter <= 6 && edge.weight >= 50;
  });
  EXPECT_TRUE(sees_the_start);
  EXPECT_LT(walk.PositionError(last.id), 0.01);
  EXPECT_LT(walk.PositionError(last.id), blind.PositionError(last.id) + 0.002);
  EXPECT_LT(walk.DuplicateShare(), 0.02);
  EXPECT_THAT(CheckConsistency(walk.mapper.atlas()), IsEmpty());
}

TEST(LocalMapper, WronglyTrackedLandmarksAreThrownOut) {
  for (std::uint64_t seed = 1; seed <= kWorlds; ++seed) {
    Walk walk(SyntheticWorldOptions{.seed = seed, .wrongly_tracked = 0.05});
    walk.WalkCircle(0, 16, 60);
    const double by_noise = walk.LargestPositionErrorOfNoise();
    EXPECT_LT(walk.LargestPositionError(), kShareOfNoise * by_noise + kMargin) << "seed " << seed;
    EXPECT_LT(walk.WrongObservationShare(), 0.01) << "seed " << seed;
  }
}

TEST(LocalMapper, MonocularMapGrowsFromTwoKeyframes) {
  Walk walk(SyntheticWorldOptions{.stereo = false, .position_noise = 0.0, .rotation_noise = 0.0});
  walk.WalkCircle(0, 2, 60);
  EXPECT_GT(walk.mapper.atlas().landmark_count(), 100U);
  walk.WalkCircle(2, 20, 60);
  std::vector<Eigen::Vector3d> truth;
  std::vector<Eigen::Vector3d> estimate;
  walk.mapper.atlas().ForEachKeyframe([&](const Keyframe& keyframe) {
    truth.push_back(walk.world.true_camera_from_world(keyframe.id).Inverse().translation());
    estimate.push_back(keyframe.camera_from_map.Inverse().translation());
  });
  const auto world_from_map = AlignPoints(truth, estimate, true);
  ASSERT_TRUE(world_from_map.has_value());
  for (std::size_t i = 0; i < truth.size(); ++i) EXPECT_LT((truth[i] - *world_from_map * estimate[i]).norm(), 0.01);
  EXPECT_LT(walk.DuplicateShare(), 0.03);
  EXPECT_THAT(CheckConsistency(walk.mapper.atlas()), IsEmpty());
}

TEST(LocalMapper, AnOpeningMakesAMapOfTwoKeyframesOnce) {
  SyntheticWorld world({.stereo = false, .position_noise = 0.0, .rotation_noise = 0.0});
  LocalMapper mapper(kSession, ExactRig());
  MapOpening opening;
  opening.first = world.NextKeyframe(CirclePose(0, 60), mapper.atlas());
  opening.second = world.NextKeyframe(CirclePose(1, 60), mapper.atlas());
  const Rigid3d& first_from_world = world.true_camera_from_world(opening.first.id);
  opening.second.reference = opening.first.id;
  opening.second.camera_from_reference = world.true_camera_from_world(opening.second.id) * first_from_world.Inverse();
  std::map<int, std::uint32_t> seen_first;
  const auto& first_points = world.points_of(opening.first.id);
  for (std::uint32_t i = 0; i < first_points.size(); ++i) seen_first.try_emplace(first_points[i], i);
  const auto& second_points = world.points_of(opening.second.id);
  for (std::uint32_t i = 0; i < second_points.size() && opening.points.size() < 100; ++i) {
    const auto first = seen_first.find(second_points[i]);
    if (first == seen_first.end()) continue;
    opening.points.push_back({first->second, i, first_from_world * world.point(second_points[i]).position});
    seen_first.erase(first);
  }
  NoStageRecorder stages;
  ASSERT_TRUE(mapper.Open(opening, stages));
  EXPECT_EQ(mapper.atlas().keyframe_count(), 2U);
  EXPECT_GT(mapper.atlas().landmark_count(), 100U) << "more are triangulated";
  EXPECT_THAT(CheckConsistency(mapper.atlas()), IsEmpty());
  const Keyframe& second = *mapper.atlas().FindKeyframe(opening.second.id);
  EXPECT_EQ(second.parent, opening.first.id);
  EXPECT_LT((second.camera_from_map * opening.second.camera_from_reference.Inverse()).Log().norm(), 0.02);
  const std::size_t landmarks = mapper.atlas().landmark_count();
  EXPECT_FALSE(mapper.Open(opening, stages)) << "the map exists";
  EXPECT_EQ(mapper.atlas().landmark_count(), landmarks);
}

TEST(LocalMapper, StandingStillKeepsFewKeyframes) {
  Walk walk;
  for (int k = 0; k < 20; ++k) walk.Visit(LookAlong({0.01 * k, 0.0, 0.0}, 0.3));
  EXPECT_LE(walk.mapper.atlas().keyframe_count(), 9U);
  EXPECT_THAT(CheckConsistency(walk.mapper.atlas()), IsEmpty());
}

TEST(LocalMapper, WalkingKeepsMostKeyframes) {
  Walk walk;
  walk.WalkCircle(0, 20, 40);
  EXPECT_GE(walk.mapper.atlas().keyframe_count(), 12U);
}

TEST(LocalMapper, AStoppedInsertLeavesAConsistentMap) {
  Walk walk;
  walk.WalkCircle(0, 4, 60);
  walk.mapper.TakeEdits();
  std::stop_source source;
  source.request_stop();
  const KeyframeId id = walk.Visit(CirclePose(4, 60), source.get_token());
  EXPECT_NE(walk.mapper.atlas().FindKeyframe(id), nullptr);
  EXPECT_THAT(CheckConsistency(walk.mapper.atlas()), IsEmpty());
  for (const MapEdit& edit : walk.mapper.TakeEdits()) EXPECT_FALSE(std::holds_alternative<MoveKeyframes>(edit));
}

TEST(LocalMapper, TheEditsTakenRebuildTheAtlas) {
  Walk walk;
  Atlas copy;
  for (int k = 0; k < 12; ++k) {
    walk.Visit(CirclePose(k, 60));
    for (const MapEdit& edit : walk.mapper.TakeEdits()) ASSERT_TRUE(Apply(edit, copy).has_value());
  }
  EXPECT_EQ(Digest(copy), Digest(walk.mapper.atlas()));
  EXPECT_THAT(walk.mapper.TakeEdits(), IsEmpty());
}

TEST(LocalMapper, TheSameKeyframesGiveTheSameMap) {
  Walk first;
  Walk second;
  first.WalkCircle(0, 10, 60);
  second.WalkCircle(0, 10, 60);
  EXPECT_EQ(Digest(first.mapper.atlas()), Digest(second.mapper.atlas()));
  EXPECT_EQ(first.mapper.atlas().version(), second.mapper.atlas().version());
}

TEST(LocalMapper, ANewMapStartsAfterTheOldOneIsClosed) {
  Walk walk;
  walk.WalkCircle(0, 5, 60);
  walk.mapper.CloseMap({kSession, 1});
  NoStageRecorder stages;
  const KeyframeCandidate late = walk.world.NextKeyframe(CirclePose(5, 60), walk.mapper.atlas());
  EXPECT_FALSE(walk.mapper.Insert(late, stages));
  walk.world.BeginMap({kSession, 2});
  for (int k = 30; k < 35; ++k) walk.Visit(CirclePose(k, 60));
  EXPECT_EQ(walk.mapper.atlas().Maps().size(), 2U);
  EXPECT_TRUE(walk.mapper.atlas().FindMap({kSession, 1})->closed);
  EXPECT_THAT(CheckConsistency(walk.mapper.atlas()), IsEmpty());
}

TEST(LocalMapper, ACandidateWithAnUnknownReferenceIsRefused) {
  Walk walk;
  walk.WalkCircle(0, 2, 60);
  KeyframeCandidate candidate = walk.world.NextKeyframe(CirclePose(2, 60), walk.mapper.atlas());
  candidate.reference = {kSession, 99};
  NoStageRecorder stages;
  const auto version = walk.mapper.atlas().version();
  EXPECT_FALSE(walk.mapper.Insert(candidate, stages));
  EXPECT_EQ(walk.mapper.atlas().version(), version);
}

TEST(LocalMapper, FramesOfAnUnknownReferenceAreLeftOut) {
  Walk walk;
  const KeyframeId root = walk.Visit(CirclePose(0, 60));
  const auto frame = [](KeyframeId reference, std::int64_t milliseconds) {
    return TrackedFrame{.reference = reference, .pose = {milliseconds * 1'000'000, Rigid3d()}};
  };
  const KeyframeId unknown{kSession, 99};
  const std::vector<TrackedFrame> frames{frame(root, 1500), frame(unknown, 1600), frame(root, 1550), frame(root, 1540),
                                         frame(root, 1700)};
  walk.mapper.AddFrames(frames);
  const auto edits = walk.mapper.TakeEdits();
  ASSERT_TRUE(std::holds_alternative<AddFramePoses>(edits.back()));
  EXPECT_EQ(std::get<AddFramePoses>(edits.back()).frames.size(), 3U);
}

TEST(LocalMapper, AMapThatForgotItsBeginningGoesOnOnWhatItHolds) {
  Walk walk;
  walk.WalkCircle(0, 12, 40);
  const std::vector<KeyframeId> beginning = {{kSession, 1}, {kSession, 2}, {kSession, 3}, {kSession, 4}};
  const auto forgotten = walk.mapper.Forget(beginning);
  EXPECT_EQ(forgotten.size(), 4U);
  EXPECT_THAT(walk.mapper.Forget(beginning), IsEmpty()) << "once";
  walk.WalkCircle(12, 20, 40);
  EXPECT_THAT(CheckConsistency(walk.mapper.atlas()), IsEmpty());
  for (const KeyframeId id : beginning) EXPECT_TRUE(IsForgotten(*walk.mapper.atlas().FindKeyframe(id)));
  EXPECT_LT(walk.LargestPositionError(), 0.05);
  // Round the whole circle, into what it has forgotten.
  walk.WalkCircle(20, 44, 40);
  EXPECT_THAT(CheckConsistency(walk.mapper.atlas()), IsEmpty());
}

}  // namespace
}  // namespace pangaea
