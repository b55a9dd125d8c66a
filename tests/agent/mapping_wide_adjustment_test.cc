#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stop_token>

#include "common/map/consistency.h"
#include "common/map/digest.h"
#include "tests/agent/mapping_walk.h"

namespace pangaea {
namespace {

using testing::ExactRig;
using ::testing::IsEmpty;
using testing::kWorlds;
using testing::SyntheticWorldOptions;
using testing::Walk;

// Local windows that are small beside the circle, as they are in flights through halls.
LocalMappingOptions SmallWindows() {
  LocalMappingOptions options = ExactRig();
  options.bundle_adjustment.window_keyframes = 5;
  options.bundle_adjustment.fixed_keyframes = 5;
  return options;
}

// Its noise makes the scale drift.
SyntheticWorldOptions OneCamera(std::uint64_t seed = 1) {
  return {
      .seed = seed, .points = 1500, .stereo = false, .pixel_noise = 0.6, .position_noise = 0.0, .rotation_noise = 0.0};
}

TEST(WideAdjustment, ComingBackSharesTheDriftAmongTheWholeWay) {
  // Over several worlds: by chance, a way drifts so little that there is nothing to share.
  double squares = 0.0;
  double squares_local = 0.0;
  for (std::uint64_t seed = 1; seed <= kWorlds; ++seed) {
    LocalMappingOptions options = SmallWindows();
    Walk walk(OneCamera(seed), options);
    options.wide_adjustment.enabled = false;
    Walk local(OneCamera(seed), options);
    walk.WalkCircle(0, 100, 60);
    local.WalkCircle(0, 100, 60);
    EXPECT_GE(walk.stages.begun["mapping.wide_adjustment"], 1);
    EXPECT_EQ(local.stages.begun["mapping.wide_adjustment"], 0);
    EXPECT_LT(walk.AlignedError(), 1.5 * local.AlignedError()) << "seed " << seed;
    EXPECT_THAT(CheckConsistency(walk.mapper.atlas()), IsEmpty());
    squares += std::pow(walk.AlignedError(), 2);
    squares_local += std::pow(local.AlignedError(), 2);
  }
  EXPECT_LT(std::sqrt(squares), 0.7 * std::sqrt(squares_local));
}

TEST(WideAdjustment, AWideAdjustmentThatLeavesTooManyContradictionsChangesNothing) {
  LocalMappingOptions options = SmallWindows();
  options.noise.pixel_sigma = 0.5;  // in a world of 0.6, so that some contradictions always remain
  options.wide_adjustment.max_outliers = 0.0;
  Walk refused(OneCamera(), options);
  options.wide_adjustment.enabled = false;
  Walk local(OneCamera(), options);
  refused.WalkCircle(0, 70, 60);
  local.WalkCircle(0, 70, 60);
  EXPECT_GE(refused.stages.begun["mapping.wide_adjustment"], 1);
  EXPECT_EQ(Digest(refused.mapper.atlas()), Digest(local.mapper.atlas()));
}

TEST(WideAdjustment, AWayThatDoesNotComeBackIsNotAdjustedAsAWhole) {
  Walk walk(SyntheticWorldOptions{.stereo = false, .position_noise = 0.0, .rotation_noise = 0.0}, SmallWindows());
  walk.WalkCircle(0, 30, 60);
  EXPECT_EQ(walk.stages.begun["mapping.wide_adjustment"], 0);
}

TEST(WideAdjustment, BeforeAMapIsClosedAllOfItIsAdjustedOnceMore) {
  double squares = 0.0;
  double squares_before = 0.0;
  LocalMappingOptions late = SmallWindows();
  late.wide_adjustment.max_strain = 0.99;  // so that nothing calls for one on the way
  for (std::uint64_t seed = 1; seed <= kWorlds; ++seed) {
    Walk walk(OneCamera(seed), late);
    walk.WalkCircle(0, 66, 60);
    squares_before += std::pow(walk.AlignedError(), 2);
    ASSERT_EQ(walk.stages.begun["mapping.wide_adjustment"], 0);
    walk.mapper.AdjustBeforeClosing(walk.mapper.atlas().Maps().front(), walk.stages);
    squares += std::pow(walk.AlignedError(), 2);
    EXPECT_EQ(walk.stages.begun["mapping.wide_adjustment"], 1);
    EXPECT_THAT(CheckConsistency(walk.mapper.atlas()), IsEmpty());
  }
  // What is left is by noise.
  EXPECT_LT(std::sqrt(squares), 0.7 * std::sqrt(squares_before));
}

TEST(WideAdjustment, BeforeAMapIsClosedNothingChangesWhereItIsAServersOrNeverWantedOrInAHurry) {
  LocalMappingOptions of_a_server = SmallWindows();
  of_a_server.wide_adjustment.enabled = false;
  LocalMappingOptions never = SmallWindows();
  never.wide_adjustment.max_strain = 1.0;
  std::stop_source hurry;
  hurry.request_stop();
  const auto changes = [](const LocalMappingOptions& options, const std::stop_token& stop) {
    Walk walk(OneCamera(), options);
    walk.WalkCircle(0, 12, 60);
    const auto before = Digest(walk.mapper.atlas());
    walk.mapper.AdjustBeforeClosing(walk.mapper.atlas().Maps().front(), walk.stages, stop);
    return Digest(walk.mapper.atlas()) != before;
  };
  EXPECT_TRUE(changes(SmallWindows(), {})) << "else there is nothing to see";
  EXPECT_FALSE(changes(of_a_server, {}));
  EXPECT_FALSE(changes(never, {}));
  EXPECT_FALSE(changes(SmallWindows(), hurry.get_token()));
}

}  // namespace
}  // namespace pangaea
