#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "agent/mapping/vergence_check.h"
#include "common/map/consistency.h"
#include "tests/agent/mapping_walk.h"

namespace pangaea {
namespace {

using testing::ExactRig;
using ::testing::IsEmpty;
using testing::kSession;
using testing::LookAlong;
using testing::SyntheticWorldOptions;
using testing::Walk;

constexpr double kTurned = 0.003;      // radians: 1.3 pixels in the synthetic rig
constexpr double kDoubtful = 0.00125;  // 0.55 pixels

// A metre and a half along the room and back towards a wall, which is near then: disparities of all sizes.
void WalkAlong(Walk& walk, int keyframes, int first = 0) {
  for (int k = first; k < first + keyframes; ++k)
    walk.Visit(LookAlong({-3.0 + 0.12 * k, 0.3 * std::sin(0.4 * k), 0.0}, 0.3 * std::sin(0.3 * k)));
}

LocalMappingOptions Unchecked() {
  LocalMappingOptions options = ExactRig();
  options.vergence.min_shift = 100.0;
  return options;
}

std::vector<double> VergencesIn(const std::vector<MapEdit>& edits) {
  std::vector<double> vergences;
  for (const MapEdit& edit : edits) {
    if (const auto* set = std::get_if<SetVergence>(&edit)) vergences.push_back(set->vergence);
  }
  return vergences;
}

TEST(MapperVergence, ATurnedCameraIsFoundAndWhatItBentIsMended) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const SyntheticWorldOptions turned{.seed = seed, .vergence = kTurned};
    Walk unchecked(turned, Unchecked());
    WalkAlong(unchecked, 24);
    Walk walk(turned);
    WalkAlong(walk, 24);
    EXPECT_NEAR(walk.mapper.vergence(), kTurned, 0.1 * kTurned) << "seed " << seed;
    walk.mapper.atlas().ForEachKeyframe([&](const Keyframe& keyframe) {
      EXPECT_EQ(keyframe.data->vergence, walk.mapper.vergence()) << "seed " << seed;
    });
    EXPECT_LT(walk.LargestPositionError(), 0.3 * unchecked.LargestPositionError()) << "seed " << seed;
    EXPECT_EQ(VergencesIn(walk.mapper.TakeEdits()).back(), walk.mapper.vergence());
    EXPECT_THAT(CheckConsistency(walk.mapper.atlas()), IsEmpty());
  }
}

TEST(MapperVergence, WhatIsFarFromTheCalibrationIsBelievedAtOnce) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Walk walk(SyntheticWorldOptions{.seed = seed, .vergence = kTurned});
    WalkAlong(walk, 10);
    EXPECT_EQ(walk.stages.begun["mapping.vergence"], 1);
    EXPECT_NEAR(walk.mapper.vergence(), kTurned, 0.15 * kTurned) << "seed " << seed;
  }
}

TEST(MapperVergence, IsBelievedWhenTheNextCheckSaysTheSame) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const SyntheticWorldOptions turned{.seed = seed, .vergence = kDoubtful};
    Walk walk(turned);
    WalkAlong(walk, 15);
    EXPECT_EQ(walk.stages.begun["mapping.vergence"], 1);
    EXPECT_EQ(walk.mapper.vergence(), 0.0) << "seed " << seed;
    WalkAlong(walk, 6, 15);
    EXPECT_EQ(walk.stages.begun["mapping.vergence"], 2);
    EXPECT_NEAR(walk.mapper.vergence(), kDoubtful, 0.1 * kDoubtful) << "seed " << seed;
  }
}

TEST(MapperVergence, AsTheMapIsClosedHalfAsManyKeyframesAreEnough) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Walk walk(SyntheticWorldOptions{.seed = seed, .vergence = kDoubtful});
    WalkAlong(walk, 10);
    const MapId map = walk.mapper.atlas().Maps().front();
    walk.mapper.AdjustBeforeClosing(map, walk.stages);
    WalkAlong(walk, 4, 10);
    walk.mapper.AdjustBeforeClosing(map, walk.stages);
    EXPECT_EQ(walk.stages.begun["mapping.vergence"], 1) << "little was seen since";
    EXPECT_EQ(walk.mapper.vergence(), 0.0) << "seed " << seed;
    WalkAlong(walk, 1, 14);
    walk.mapper.AdjustBeforeClosing(map, walk.stages);
    EXPECT_EQ(walk.stages.begun["mapping.vergence"], 2);
    EXPECT_NEAR(walk.mapper.vergence(), kDoubtful, 0.15 * kDoubtful) << "seed " << seed;
  }
}

TEST(MapperVergence, IsNotBelievedWhenTheNextCheckContradictsIt) {
  LocalMappingOptions options = ExactRig();
  options.vergence.window_keyframes = 10;  // so that the two checks have no keyframe in common
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Walk walk(SyntheticWorldOptions{.seed = seed, .vergence = kDoubtful}, options);
    WalkAlong(walk, 10);
    walk.world.TurnRightCamera(-kDoubtful);
    WalkAlong(walk, 12, 10);
    EXPECT_EQ(walk.stages.begun["mapping.vergence"], 2);
    EXPECT_EQ(walk.mapper.vergence(), 0.0) << "seed " << seed;
  }
}

TEST(MapperVergence, AnExactCalibrationStays) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Walk walk(SyntheticWorldOptions{.seed = seed});
    WalkAlong(walk, 24);
    EXPECT_GT(walk.stages.begun["mapping.vergence"], 0);
    EXPECT_THAT(VergencesIn(walk.mapper.TakeEdits()), IsEmpty()) << "seed " << seed;
  }
}

// What a walk says of whose mapper does not look itself: so many keyframes of a rig turned by `first`, then by `then`.
std::optional<double> FoundAfter(SyntheticWorldOptions world, int keyframes, double first, int more, double then,
                                 const VergenceOptions& options = {}) {
  world.vergence = first;
  Walk walk(world, Unchecked());
  WalkAlong(walk, keyframes);
  walk.world.TurnRightCamera(then);
  WalkAlong(walk, more, keyframes);
  const KeyframeId newest{kSession, static_cast<std::uint32_t>(keyframes + more)};
  return FindBetterVergence(walk.mapper.atlas(), newest, options, ExactRig().noise, {}).better;
}

TEST(MapperVergence, WhatTheNewestKeyframesAloneSayIsNotBelieved) {
  VergenceOptions without_witness;
  without_witness.first_keyframes = 20;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const SyntheticWorldOptions world{.seed = seed};
    EXPECT_TRUE(FoundAfter(world, 18, 0.0, 24, kTurned, without_witness)) << "seed " << seed;
    EXPECT_EQ(FoundAfter(world, 18, 0.0, 24, kTurned), std::nullopt) << "seed " << seed;
    const auto found = FoundAfter(world, 18, kTurned, 24, kTurned);
    ASSERT_TRUE(found) << "seed " << seed;
    EXPECT_NEAR(*found, kTurned, 0.1 * kTurned) << "seed " << seed;
    // Of the two the smaller.
    const auto between = FoundAfter(world, 18, 0.5 * kTurned, 24, kTurned);
    ASSERT_TRUE(between) << "seed " << seed;
    EXPECT_GT(*between, 0.2 * kTurned) << "seed " << seed;
    EXPECT_LT(*between, 0.6 * kTurned) << "seed " << seed;
  }
}

TEST(MapperVergence, ASmallErrorWaitsUntilKeyframesElsewhereSayTheSame) {
  constexpr double kSlight = 0.0005;  // radians: 0.22 pixels
  VergenceOptions hasty;
  hasty.min_lone_shift = 0.0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const SyntheticWorldOptions sharp{.seed = seed, .pixel_noise = 0.1};
    EXPECT_TRUE(FoundAfter(sharp, 12, kSlight, 8, kSlight, hasty)) << "seed " << seed;
    EXPECT_EQ(FoundAfter(sharp, 12, kSlight, 8, kSlight), std::nullopt) << "seed " << seed;
    const auto found = FoundAfter(sharp, 26, kSlight, 26, kSlight);
    ASSERT_TRUE(found) << "seed " << seed;
    EXPECT_NEAR(*found, kSlight, 0.2 * kSlight) << "seed " << seed;
  }
}

TEST(MapperVergence, IsLookedAtEachTimeTheKeyframesDouble) {
  LocalMappingOptions options = ExactRig();
  options.vergence.first_keyframes = 6;
  Walk walk({}, options);
  WalkAlong(walk, 5);
  EXPECT_EQ(walk.stages.begun["mapping.vergence"], 0);
  WalkAlong(walk, 7);
  EXPECT_EQ(walk.stages.begun["mapping.vergence"], 2);
}

}  // namespace
}  // namespace pangaea
