#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "common/map/consistency.h"
#include "common/map/covisibility.h"
#include "common/map/map_edit.h"
#include "common/map/spanning_tree.h"
#include "server/fusion/seam.h"
#include "server/fusion/welding_window.h"
#include "tests/server/fusion_world.h"

namespace pangaea::testing {
namespace {

using ::testing::IsEmpty;

constexpr int kRound = 40;       // keyframes of one round through the room
constexpr std::size_t kEnd = 3;  // a keyframe near the start that is seen again after the round

FusionOptions SmallWindow() {
  FusionOptions options;
  options.window.keyframes = 7;
  return options;
}

// One session goes once around and a bit farther, with this drift from keyframe to keyframe, and does not recognise
// where it began.
SurveyedWorld Round(std::uint64_t seed, const SurveyOptions& drift) {
  SurveyedWorld world(seed);
  SurveyOptions options = drift;
  options.remembered = 6;
  world.Fly(kOlder, CirclePoses(0, kRound + 6, kRound), options);
  return world;
}

SurveyOptions StereoDrift() {
  SurveyOptions options;
  options.drift_per_keyframe << 0.004, -0.003, 0.001, 0.0003, -0.0002, 0.0004;
  return options;
}

PlaceMatch ClosingMatch(const SurveyedWorld& world) {
  return world.TrueMatch(world.KeyframesOf(kOlder)[kRound + kEnd], world.KeyframesOf(kOlder)[kEnd]);
}

// Corners of which each side of the window sees a landmark of its own.
std::size_t CountDuplicatesAcross(const SurveyedWorld& world, const Atlas& atlas, const WeldingWindow& window) {
  std::map<int, std::set<LandmarkId>> of_corner;
  const auto corner_of = [&](LandmarkId id) { return world.CornerOf(atlas.FindLandmark(id)->observations.front()); };
  for (const LandmarkId id : LandmarksSeenBy(atlas, window.kept)) of_corner[corner_of(id)].insert(id);
  std::size_t duplicates = 0;
  for (const LandmarkId id : LandmarksSeenBy(atlas, window.moved)) {
    const auto of_kept = of_corner.find(corner_of(id));
    if (of_kept != of_corner.end() && !of_kept->second.contains(id)) ++duplicates;
  }
  return duplicates;
}

class Loop : public ::testing::TestWithParam<std::uint64_t> {};
INSTANTIATE_TEST_SUITE_P(Seeds, Loop, ::testing::Range<std::uint64_t>(1, 6));

TEST_P(Loop, TheMovedEndComesToLieOnTheKeptOne) {
  const SurveyedWorld world = Round(GetParam(), StereoDrift());
  const PlaceMatch match = ClosingMatch(world);
  ASSERT_GT(WorstError(world, world.atlas, {match.candidate, match.query}), 0.1);
  const WeldingOutcome plan = PlanWelding(world.atlas, match, SmallWindow(), {});
  ASSERT_TRUE(plan.has_value()) << Describe(plan.error());
  EXPECT_FALSE(plan->is_merge());
  Atlas atlas = world.atlas;
  const WeldingWindow window = GrowWeldingWindow(world.atlas, *FindSeam(world.atlas, match), SmallWindow().window);
  ASSERT_GT(CountDuplicatesAcross(world, atlas, window), 100U);
  Carry(*plan, atlas);
  EXPECT_THAT(CheckConsistency(atlas), IsEmpty());
  EXPECT_LT(WorstError(world, atlas, {match.candidate, match.query}), 0.02);
  EXPECT_EQ(CountDuplicatesAcross(world, atlas, window), 0U);
  EXPECT_EQ(CountMixed(world, atlas), 0U);
}

TEST_P(Loop, WhatAnEarlierCorrectionPlacedIsMovedLikeAnythingElse) {
  const SurveyedWorld world = Round(GetParam(), StereoDrift());
  const PlaceMatch match = ClosingMatch(world);
  Atlas placed = world.atlas;
  std::vector<std::pair<KeyframeId, Rigid3d>> poses;
  for (const KeyframeId id : world.KeyframesOf(kOlder)) {
    poses.emplace_back(id, placed.FindKeyframe(id)->camera_from_map);
  }
  MoveKeyframes said_anew = MoveKeyframesTo(placed, poses);
  said_anew.correction = 7;
  ASSERT_TRUE(Apply(said_anew, placed).has_value());
  const WeldingOutcome plan = PlanWelding(placed, match, SmallWindow(), {});
  ASSERT_TRUE(plan.has_value()) << Describe(plan.error());
  Carry(*plan, placed);
  EXPECT_LT(WorstError(world, placed, {match.candidate, match.query}), 0.02);
}

TEST_P(Loop, TheEdgeSaysWhatTheCorrectedPosesSay) {
  const SurveyedWorld world = Round(GetParam(), StereoDrift());
  const PlaceMatch match = ClosingMatch(world);
  const WeldingOutcome plan = PlanWelding(world.atlas, match, SmallWindow(), {});
  ASSERT_TRUE(plan.has_value()) << Describe(plan.error());
  Atlas atlas = world.atlas;
  Carry(*plan, atlas);
  ASSERT_EQ(atlas.loop_edges().size(), 1U);
  const LoopEdge& edge = atlas.loop_edges().front();
  EXPECT_EQ(edge.from, match.query);
  EXPECT_EQ(edge.to, match.candidate);
  EXPECT_EQ(edge.to_from_from.scale(), 1.0);
  const Rigid3d motion =
      atlas.FindKeyframe(edge.to)->camera_from_map * atlas.FindKeyframe(edge.from)->camera_from_map.Inverse();
  EXPECT_LT((motion.translation() - edge.to_from_from.translation()).norm(), 1e-9);
}

TEST_P(Loop, OfAScaleFreeMapTheCorrectionTakesTheDriftedScaleBack) {
  SurveyOptions monocular;
  monocular.stereo = false;
  monocular.scale_drift_per_keyframe = 0.002;
  const SurveyedWorld world = Round(GetParam(), monocular);
  PlaceMatch match = ClosingMatch(world);
  const double drifted = std::exp(monocular.scale_drift_per_keyframe * (kRound + kEnd));
  const Similarity3d& motion = match.candidate_from_query;  // in the lengths of the query, which have grown
  match.candidate_from_query = Similarity3d(1.0 / drifted, motion.rotation(), motion.translation());
  const WeldingOutcome plan = PlanWelding(world.atlas, match, SmallWindow(), {});
  ASSERT_TRUE(plan.has_value()) << Describe(plan.error());
  for (const CorrectedKeyframe& keyframe : plan->correction.keyframes) {
    const bool is_moved = keyframe.id.counter > kRound / 2;
    EXPECT_NEAR(keyframe.scale, is_moved ? 1.0 / drifted : 1.0, 0.01) << ToString(keyframe.id);
  }
  Atlas atlas = world.atlas;
  Carry(*plan, atlas);
  EXPECT_THAT(CheckConsistency(atlas), IsEmpty());
  const std::vector<KeyframeId>& all = world.KeyframesOf(kOlder);
  EXPECT_LT(WorstError(world, atlas, {all[kRound + kEnd - 1], all[kRound + kEnd], all[kRound + kEnd + 1]}), 0.02);
}

TEST(Drift, ALoopThatAsksForMoreDriftThanTheWayAllowsIsRefused) {
  const SurveyedWorld world = Round(1, StereoDrift());
  PlaceMatch match = ClosingMatch(world);
  match.candidate_from_query =
      Similarity3d(Rigid3d(Eigen::Quaterniond::Identity(), {1.5, 0.0, 0.5})) * match.candidate_from_query;
  const WeldingOutcome plan = PlanWelding(world.atlas, match, SmallWindow(), {});
  ASSERT_FALSE(plan.has_value());
  EXPECT_EQ(plan.error().reason, WeldingRefusalReason::kContradiction) << Describe(plan.error());
  EXPECT_GT(plan.error().evidence.drift.path, 5.0);
}

TEST(Drift, AnEarlierLoopLeavesLessRoomForTheNext) {
  const SurveyedWorld world = Round(2, StereoDrift());
  PlaceMatch wrong = world.TrueMatch(world.KeyframesOf(kOlder)[kRound + 4], world.KeyframesOf(kOlder)[4]);
  wrong.candidate_from_query =
      Similarity3d(Rigid3d(Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.55})) * wrong.candidate_from_query;
  const DriftOptions options;
  EXPECT_TRUE(MeasureDrift(world.atlas, *FindSeam(world.atlas, wrong), options).is_plausible());
  Atlas closed = world.atlas;
  const WeldingOutcome plan = PlanWelding(closed, ClosingMatch(world), SmallWindow(), {});
  ASSERT_TRUE(plan.has_value()) << Describe(plan.error());
  Carry(*plan, closed);
  const WeldingOutcome second = PlanWelding(closed, wrong, SmallWindow(), {});
  ASSERT_FALSE(second.has_value());
  EXPECT_EQ(second.error().reason, WeldingRefusalReason::kContradiction) << Describe(second.error());
}

TEST(Window, ItsSidesAreDisjointOfTheirSizeAndBeginAtTheEnds) {
  const SurveyedWorld world = Round(1, StereoDrift());
  const Seam seam = *FindSeam(world.atlas, ClosingMatch(world));
  const WeldingWindow window = GrowWeldingWindow(world.atlas, seam, {.keyframes = 7, .fixed_keyframes = 4});
  EXPECT_EQ(window.kept.size(), 7U);
  EXPECT_EQ(window.moved.size(), 7U);
  EXPECT_EQ(window.kept.front(), seam.kept);
  EXPECT_EQ(window.moved.front(), seam.moved);
  std::set<KeyframeId> all(window.kept.begin(), window.kept.end());
  all.insert(window.moved.begin(), window.moved.end());
  EXPECT_EQ(all.size(), 14U);
}

TEST(Window, TheRootAndTheRingAroundTheKeptSideAreFixed) {
  const SurveyedWorld world = Round(1, StereoDrift());
  const Seam seam = *FindSeam(world.atlas, ClosingMatch(world));
  const WeldingWindow window = GrowWeldingWindow(world.atlas, seam, {.keyframes = 5, .fixed_keyframes = 4});
  const KeyframeId root = world.atlas.FindMap(seam.kept_map)->root;
  const std::set<KeyframeId> fixed(window.fixed.begin(), window.fixed.end());
  const std::set<KeyframeId> kept(window.kept.begin(), window.kept.end());
  EXPECT_EQ(fixed.contains(root), true);
  std::size_t outside = 0;
  for (const KeyframeId id : fixed) outside += kept.contains(id) ? 0 : 1;
  EXPECT_EQ(outside, 4U);
}

}  // namespace
}  // namespace pangaea::testing
