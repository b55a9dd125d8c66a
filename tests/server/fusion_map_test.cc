#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/map/consistency.h"
#include "server/fusion/landmark_index.h"
#include "server/fusion/map_fusion.h"
#include "tests/server/fusion_world.h"

namespace pangaea::testing {
namespace {

using ::testing::IsEmpty;

// Two sessions that flew the same half circle, welded at one end of it by a small window.
class MapFusionTest : public ::testing::TestWithParam<std::uint64_t> {
 protected:
  MapFusionTest() : world_(GetParam()) {
    world_.Fly(kOlder, CirclePoses(0, 20, 40), {});
    SurveyOptions second;
    second.stamp_ns = 1'000'000'000'000;
    second.map_from_world = RandomFrame(GetParam());
    world_.Fly(kNewer, CirclePoses(0, 20, 40), second);
    FusionOptions options;
    options.window.keyframes = 5;
    const PlaceMatch match = world_.TrueMatch(world_.KeyframesOf(kNewer)[2], world_.KeyframesOf(kOlder)[2]);
    const WeldingOutcome plan = PlanWelding(world_.atlas, match, options, {});
    EXPECT_TRUE(plan.has_value()) << Describe(plan.error());
    merged_ = world_.atlas;
    if (plan) testing::Carry(*plan, merged_);
  }

  void Carry(const MapFusion& fusion, Atlas& atlas) {
    ApplyTolerantly(fusion.edits, atlas);
    for (const MapEdit& edit : Rebase(fusion.correction, atlas)) EXPECT_TRUE(Apply(edit, atlas).has_value());
  }

  SurveyedWorld world_;
  Atlas merged_;
};
INSTANTIATE_TEST_SUITE_P(Seeds, MapFusionTest, ::testing::Range<std::uint64_t>(1, 4));

TEST_P(MapFusionTest, DuplicatesFarFromTheSeamBecomeOne) {
  const std::size_t before = CountDuplicates(world_, merged_);
  ASSERT_GT(before, 300U);
  Atlas atlas = merged_;
  const MapFusion fusion = FuseDuplicates(atlas, {kOlder, 1}, {}, LookedAtMap(), {});
  Carry(fusion, atlas);
  EXPECT_THAT(CheckConsistency(atlas), IsEmpty());
  EXPECT_LT(CountDuplicates(world_, atlas), before / 20);
  EXPECT_LE(CountMixed(world_, atlas), 1U);
  EXPECT_EQ(before - CountDuplicates(world_, atlas), merged_.landmark_count() - atlas.landmark_count());
}

TEST_P(MapFusionTest, WhereNothingIsTwiceNothingHappens) {
  Atlas atlas = merged_;
  Carry(FuseDuplicates(atlas, {kOlder, 1}, {}, LookedAtMap(), {}), atlas);
  Carry(FuseDuplicates(atlas, {kOlder, 1}, {}, LookedAtMap(), {}), atlas);
  const MapFusion again = FuseDuplicates(atlas, {kOlder, 1}, {}, LookedAtMap(), {});
  EXPECT_LE(again.fused, 2U);
}

TEST_P(MapFusionTest, AStopEndsItWithNothingDone) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THAT(FuseDuplicates(merged_, {kOlder, 1}, {}, LookedAtMap(), stop.get_token()).edits, IsEmpty());
}

// The index leaves out nothing that a look at every landmark finds.
TEST_P(MapFusionTest, TheIndexFindsExactlyWhatIsInView) {
  const LandmarkIndex index(merged_, {kOlder, 1}, 0.4);
  for (const KeyframeId id : AllKeyframes(world_)) {
    const Viewpoint viewpoint(*merged_.FindKeyframe(id));
    std::vector<LandmarkId> in_view;
    merged_.ForEachLandmark([&](const Landmark& landmark) {
      const Eigen::Vector3d point = viewpoint.camera_from_map * landmark.point_in_map;
      if (point.z() > 0.0 && viewpoint.camera.Contains(viewpoint.camera.Project(point))) in_view.push_back(landmark.id);
    });
    EXPECT_EQ(index.InView(viewpoint), in_view);
  }
}

TEST(MapFusionOptions, ANonsenseValueIsNamed) {
  MapFusionOptions options;
  EXPECT_TRUE(options.Check().has_value());
  options.cube_edge = -1.0;
  const Status status = options.Check();
  ASSERT_FALSE(status.has_value());
  EXPECT_THAT(status.error().message, ::testing::HasSubstr("cube_edge"));
}

}  // namespace
}  // namespace pangaea::testing
