#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "common/map/consistency.h"
#include "server/fusion/seam.h"
#include "tests/server/fusion_world.h"

namespace pangaea::testing {
namespace {

using ::testing::IsEmpty;

const MapId kOlderMap{kOlder, 1};
const MapId kNewerMap{kNewer, 1};

// What each landmark is: the set of the keypoints that show it.
std::set<std::vector<std::pair<KeyframeId, std::uint32_t>>> Partition(const Atlas& atlas) {
  std::set<std::vector<std::pair<KeyframeId, std::uint32_t>>> partition;
  atlas.ForEachLandmark([&](const Landmark& landmark) {
    std::vector<std::pair<KeyframeId, std::uint32_t>> keypoints;
    for (const Observation& observation : landmark.observations) {
      keypoints.emplace_back(observation.keyframe, observation.keypoint);
    }
    partition.insert(std::move(keypoints));
  });
  return partition;
}

// The largest difference between where two atlases see keyframes from the first of them.
double WorstDifference(const Atlas& a, const Atlas& b, const std::vector<KeyframeId>& keyframes) {
  const Rigid3d& first_in_a = a.FindKeyframe(keyframes.front())->camera_from_map;
  const Rigid3d& first_in_b = b.FindKeyframe(keyframes.front())->camera_from_map;
  double worst = 0.0;
  for (const KeyframeId id : keyframes) {
    const Eigen::Vector3d in_a = first_in_a * a.FindKeyframe(id)->camera_from_map.Inverse().translation();
    const Eigen::Vector3d in_b = first_in_b * b.FindKeyframe(id)->camera_from_map.Inverse().translation();
    worst = std::max(worst, (in_a - in_b).norm());
  }
  return worst;
}

Atlas Welded(const SurveyedWorld& world, const PlaceMatch& match, const FusionOptions& options = {}) {
  Atlas atlas = world.atlas;
  const WeldingOutcome plan = PlanWelding(world.atlas, match, options, {});
  EXPECT_TRUE(plan.has_value()) << Describe(plan.error());
  if (plan) Carry(*plan, atlas);
  EXPECT_THAT(CheckConsistency(atlas), IsEmpty());
  return atlas;
}

PlaceMatch Reversed(const PlaceMatch& match) {
  PlaceMatch reversed = match;
  std::swap(reversed.query, reversed.candidate);
  reversed.candidate_from_query = match.candidate_from_query.Inverse();
  for (auto& [first, second] : reversed.landmarks) std::swap(first, second);
  return reversed;
}

PlaceMatch Disturbed(PlaceMatch match, const Vector6d& twist, double scale = 1.0) {
  const Rigid3d error = Rigid3d::Exp(twist);
  match.candidate_from_query = Similarity3d(scale, error.rotation(), error.translation()) * match.candidate_from_query;
  return match;
}

Vector6d Twist(double x, double y, double z, double a, double b, double c) {
  return (Vector6d() << x, y, z, a, b, c).finished();
}

class Merge : public ::testing::TestWithParam<std::uint64_t> {};
INSTANTIATE_TEST_SUITE_P(Seeds, Merge, ::testing::Range<std::uint64_t>(1, 6));

TEST_P(Merge, TwoMapsOfOneRoomBecomeOneWithoutDuplicates) {
  const SurveyedWorld world = TwoMaps(GetParam());
  ASSERT_GT(CountDuplicates(world, world.atlas), 200U);
  const Atlas atlas = Welded(world, MiddleMatch(world));
  EXPECT_EQ(atlas.Maps(), std::vector<MapId>({kOlderMap}));
  EXPECT_EQ(atlas.Resolve(kNewerMap), kOlderMap);
  EXPECT_EQ(atlas.loop_edges().size(), 1U);
  EXPECT_EQ(CountDuplicates(world, atlas), 0U);
  EXPECT_EQ(CountMixed(world, atlas), 0U);
  EXPECT_LT(WorstError(world, atlas, AllKeyframes(world)), 0.02);
}

TEST_P(Merge, AMatchThatIsALittleOffIsMended) {
  const SurveyedWorld world = TwoMaps(GetParam());
  const Atlas atlas = Welded(world, Disturbed(MiddleMatch(world), Twist(0.01, -0.02, 0.02, 0.004, 0.006, -0.003)));
  EXPECT_EQ(CountDuplicates(world, atlas), 0U);
  EXPECT_EQ(CountMixed(world, atlas), 0U);
  EXPECT_LT(WorstError(world, atlas, AllKeyframes(world)), 0.02);
}

TEST_P(Merge, WhichKeyframeWasRecognisedMakesNoDifference) {
  const SurveyedWorld world = TwoMaps(GetParam());
  const Atlas one = Welded(world, MiddleMatch(world));
  const Atlas other = Welded(world, Reversed(MiddleMatch(world)));
  EXPECT_EQ(Partition(one), Partition(other));
  EXPECT_LT(WorstDifference(one, other, AllKeyframes(world)), 1e-6);
}

TEST_P(Merge, InEitherOrderGivesTheSameMapUpToGauge) {
  SurveyOptions later;
  SurveyOptions earlier;
  earlier.stamp_ns = -2'000'000'000'000;
  const SurveyedWorld world = TwoMaps(GetParam(), later);
  const SurveyedWorld swapped = TwoMaps(GetParam(), earlier);
  FusionOptions converged;
  converged.iterations = 100;
  converged.iterations_without_outliers = 100;
  const Atlas one = Welded(world, MiddleMatch(world), converged);
  const Atlas other = Welded(swapped, MiddleMatch(swapped), converged);
  ASSERT_EQ(one.Maps(), std::vector<MapId>({kOlderMap}));
  ASSERT_EQ(other.Maps(), std::vector<MapId>({kNewerMap}));
  EXPECT_EQ(Partition(one), Partition(other));
  EXPECT_LT(WorstDifference(one, other, AllKeyframes(world)), 0.001);
}

TEST_P(Merge, AMatchThatIsWrongByHalfAMetreIsRefused) {
  const SurveyedWorld world = TwoMaps(GetParam());
  const WeldingOutcome plan =
      PlanWelding(world.atlas, Disturbed(MiddleMatch(world), Twist(0.3, -0.4, 0.0, 0.0, 0.0, 0.0)), {}, {});
  ASSERT_FALSE(plan.has_value());
  EXPECT_EQ(plan.error().reason, WeldingRefusalReason::kTooFewCommonLandmarks) << Describe(plan.error());
}

TEST_P(Merge, AMatchThatIsWrongByFiveDegreesIsRefused) {
  const SurveyedWorld world = TwoMaps(GetParam());
  const WeldingOutcome plan =
      PlanWelding(world.atlas, Disturbed(MiddleMatch(world), Twist(0.0, 0.0, 0.0, 0.0, 0.087, 0.0)), {}, {});
  ASSERT_FALSE(plan.has_value());
  EXPECT_EQ(plan.error().reason, WeldingRefusalReason::kTooFewCommonLandmarks) << Describe(plan.error());
}

TEST_P(Merge, AMonocularMapTakesItsScaleFromTheStereoMap) {
  SurveyOptions monocular;
  monocular.stereo = false;
  monocular.map_from_world = Similarity3d(0.37, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero());
  const SurveyedWorld world = TwoMaps(GetParam(), monocular);
  const Atlas atlas = Welded(world, Disturbed(MiddleMatch(world), Twist(0.0, 0.0, 0.01, 0.0, 0.0, 0.0), 1.005));
  EXPECT_EQ(CountDuplicates(world, atlas), 0U);
  EXPECT_LT(WorstError(world, atlas, AllKeyframes(world)), 0.02);
  // By itself, too: a length in it is a length in the room.
  const std::vector<KeyframeId>& keyframes = world.KeyframesOf(kNewer);
  EXPECT_LT(WorstError(world, atlas, keyframes), 0.01 * 1.5);
}

TEST_P(Merge, TwoMonocularMapsShareTheScaleOfTheOlder) {
  SurveyOptions first;
  first.stereo = false;
  first.map_from_world = Similarity3d(2.5, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero());
  SurveyOptions second;
  second.stereo = false;
  second.map_from_world = Similarity3d(0.8, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero());
  const SurveyedWorld world = TwoMaps(GetParam(), second, first);
  const Atlas atlas = Welded(world, MiddleMatch(world));
  EXPECT_EQ(atlas.Maps(), std::vector<MapId>({kOlderMap}));
  // What either map sees once has no depth: nobody can say whether it is the same.
  EXPECT_LE(CountDuplicates(world, atlas), CountDuplicates(world, world.atlas) / 50);
  EXPECT_LT(WorstError(world, atlas, AllKeyframes(world), 2.5), 2.5 * 0.03);
}

TEST(Survivor, AMetricMapBeatsAnOlderScaleFreeOne) {
  SurveyOptions monocular;
  monocular.stereo = false;
  const SurveyedWorld world = TwoMaps(1, {}, monocular);
  EXPECT_EQ(Survivor(world.atlas, kOlderMap, kNewerMap), kNewerMap);
  EXPECT_EQ(Welded(world, MiddleMatch(world)).Maps(), std::vector<MapId>({kNewerMap}));
}

TEST(Survivor, TheOlderOfTwoMetricMapsKeepsItsIdAndItsOrigin) {
  const SurveyedWorld world = TwoMaps(1);
  EXPECT_EQ(Survivor(world.atlas, kNewerMap, kOlderMap), kOlderMap);
  const KeyframeId root = world.KeyframesOf(kOlder).front();
  const Atlas atlas = Welded(world, MiddleMatch(world));
  EXPECT_EQ(atlas.FindKeyframe(root)->camera_from_map.Matrix(),
            world.atlas.FindKeyframe(root)->camera_from_map.Matrix());
}

TEST(Welding, KeyframesOfTheMatchThatWereCulledSinceAreReplacedByTheirParents) {
  SurveyedWorld world = TwoMaps(1);
  const PlaceMatch match = MiddleMatch(world);
  ASSERT_TRUE(Apply(RemoveKeyframe{match.query}, world.atlas));
  ASSERT_TRUE(Apply(RemoveKeyframe{match.candidate}, world.atlas));
  const WeldingOutcome plan = PlanWelding(world.atlas, match, {}, {});
  ASSERT_TRUE(plan.has_value()) << Describe(plan.error());
  EXPECT_EQ(plan->moved, world.KeyframesOf(kNewer)[1]);
  EXPECT_EQ(plan->kept, world.KeyframesOf(kOlder)[7]);
}

TEST(Welding, AMatchOfWhatIsGoneIsRefused) {
  const SurveyedWorld world = TwoMaps(1);
  PlaceMatch match = MiddleMatch(world);
  match.query = {0x33, 7};
  const WeldingOutcome plan = PlanWelding(world.atlas, match, {}, {});
  ASSERT_FALSE(plan.has_value());
  EXPECT_EQ(plan.error().reason, WeldingRefusalReason::kGone);
}

TEST(Welding, ARequestedStopEndsIt) {
  const SurveyedWorld world = TwoMaps(1);
  std::stop_source stop;
  stop.request_stop();
  const WeldingOutcome plan = PlanWelding(world.atlas, MiddleMatch(world), {}, stop.get_token());
  ASSERT_FALSE(plan.has_value());
  EXPECT_EQ(plan.error().reason, WeldingRefusalReason::kCancelled);
}

TEST(Welding, TheSameMatchGivesTheSamePlan) {
  const SurveyedWorld world = TwoMaps(3);
  const WeldingOutcome one = PlanWelding(world.atlas, MiddleMatch(world), {}, {});
  const WeldingOutcome other = PlanWelding(world.atlas, MiddleMatch(world), {}, {});
  ASSERT_TRUE(one && other);
  EXPECT_EQ(EncodeEdits(one->edits), EncodeEdits(other->edits));
  EXPECT_EQ(EncodeEdits(Rebase(one->correction, one->correction.base)),
            EncodeEdits(Rebase(other->correction, other->correction.base)));
}

TEST(ApplyTolerantly, WithoutItsMergeNothingOfAPlanIsApplied) {
  const SurveyedWorld world = TwoMaps(1);
  const WeldingOutcome plan = PlanWelding(world.atlas, MiddleMatch(world), {}, {});
  ASSERT_TRUE(plan.has_value());
  Atlas atlas = world.atlas;
  EXPECT_EQ(ApplyTolerantly(plan->edits, atlas).size(), plan->edits.size());
  const std::uint64_t version = atlas.version();
  EXPECT_THAT(ApplyTolerantly(plan->edits, atlas), IsEmpty());  // the merge is done already
  EXPECT_EQ(atlas.version(), version);
}

TEST(FusionOptions, DefaultsAreInRangeAndANonsenseValueIsNamed) {
  FusionOptions options;
  EXPECT_TRUE(options.Check().has_value());
  options.judgement.min_inlier_share = 1.5;
  const Status status = options.Check();
  ASSERT_FALSE(status.has_value());
  EXPECT_THAT(status.error().message, ::testing::HasSubstr("judgement.min_inlier_share"));
}

}  // namespace
}  // namespace pangaea::testing
