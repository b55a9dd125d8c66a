#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/map/consistency.h"
#include "tests/server/fusion_world.h"

namespace pangaea::testing {
namespace {

using ::testing::IsEmpty;

class Merge : public ::testing::TestWithParam<std::uint64_t> {};
INSTANTIATE_TEST_SUITE_P(Seeds, Merge, ::testing::Range<std::uint64_t>(1, 6));

TEST_P(Merge, TwoMapsOfOneRoomBecomeOneWithoutDuplicates) {
  const SurveyedWorld world = TwoMaps(GetParam());
  ASSERT_GT(CountDuplicates(world, world.atlas), 200U);
  const WeldingOutcome plan = PlanWelding(world.atlas, MiddleMatch(world), {}, {});
  ASSERT_TRUE(plan.has_value()) << Describe(plan.error());
  Atlas atlas = world.atlas;
  Carry(*plan, atlas);
  EXPECT_THAT(CheckConsistency(atlas), IsEmpty());
  EXPECT_EQ(atlas.Maps(), std::vector<MapId>({{kOlder, 1}}));
  EXPECT_EQ(atlas.Resolve(MapId{kNewer, 1}), (MapId{kOlder, 1}));
  EXPECT_EQ(CountDuplicates(world, atlas), 0U);
  EXPECT_EQ(CountMixed(world, atlas), 0U);
  EXPECT_LT(WorstError(world, atlas, AllKeyframes(world)), 0.02);
}

}  // namespace
}  // namespace pangaea::testing
