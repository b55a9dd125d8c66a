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

TEST(WideAdjustment, ComingBackSharesTheDriftAmongTheWholeWay) {
  // Over several worlds: by chance, a way drifts so little that there is nothing to share.
  double squares = 0.0;
  double squares_local = 0.0;
  for (std::uint64_t seed = 1; seed <= kWorlds; ++seed) {
    const SyntheticWorldOptions one_camera{.seed = seed,
                                           .points = 1500,
                                           .stereo = false,
                                           .pixel_noise = 0.6,
                                           .position_noise = 0.0,
                                           .rotation_noise = 0.0};
    LocalMappingOptions options = SmallWindows();
    Walk walk(one_camera, options);
    options.wide_adjustment.enabled = false;
    Walk local(one_camera, options);
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
  const SyntheticWorldOptions one_camera{
      .points = 1500, .stereo = false, .pixel_noise = 0.6, .position_noise = 0.0, .rotation_noise = 0.0};
  LocalMappingOptions options = SmallWindows();
  options.noise.pixel_sigma = 0.5;  // in a world of 0.6, so that some contradictions always remain
  options.wide_adjustment.max_outliers = 0.0;
  Walk refused(one_camera, options);
  options.wide_adjustment.enabled = false;
  Walk local(one_camera, options);
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
  for (std::uint64_t seed = 1; seed <= kWorlds; ++seed) {
    const SyntheticWorldOptions one_camera{
        .seed = seed, .stereo = false, .pixel_noise = 0.6, .position_noise = 0.0, .rotation_noise = 0.0};
    Walk walk(one_camera, SmallWindows());
    walk.WalkCircle(0, 66, 60);
    squares_before += std::pow(walk.AlignedError(), 2);
    walk.mapper.AdjustBeforeClosing(walk.mapper.atlas().Maps().front(), walk.stages);
    squares += std::pow(walk.AlignedError(), 2);
    EXPECT_GE(walk.stages.begun["mapping.wide_adjustment"], 1);
    EXPECT_THAT(CheckConsistency(walk.mapper.atlas()), IsEmpty());
  }
  // What is left is by noise.
  EXPECT_LT(std::sqrt(squares), 0.93 * std::sqrt(squares_before));
}

TEST(WideAdjustment, BeforeAMapIsClosedNothingChangesWhereItIsAServersOrNeverWantedOrInAHurry) {
  LocalMappingOptions of_a_server = SmallWindows();
  of_a_server.wide_adjustment.enabled = false;
  LocalMappingOptions never = SmallWindows();
  never.wide_adjustment.max_strain = 1.0;
  std::stop_source hurry;
  for (const LocalMappingOptions& options : {of_a_server, never, SmallWindows()}) {
    Walk walk({}, options);
    walk.WalkCircle(0, 5, 60);
    const auto before = Digest(walk.mapper.atlas());
    const bool would_adjust = options.wide_adjustment.enabled && options.wide_adjustment.max_strain < 1.0;
    if (would_adjust) hurry.request_stop();
    walk.mapper.AdjustBeforeClosing(walk.mapper.atlas().Maps().front(), walk.stages, hurry.get_token());
    EXPECT_EQ(Digest(walk.mapper.atlas()), before);
  }
}

}  // namespace
}  // namespace pangaea
