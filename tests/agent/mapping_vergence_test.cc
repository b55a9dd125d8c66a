#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

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

constexpr double kTurned = 0.003;  // radians: more than a pixel in the synthetic rig

// A metre and a half along the room and back towards a wall, which is near then: disparities of all sizes.
void WalkAlong(Walk& walk, int keyframes) {
  for (int k = 0; k < keyframes; ++k)
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

TEST(MapperVergence, AnExactCalibrationStays) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Walk walk(SyntheticWorldOptions{.seed = seed});
    WalkAlong(walk, 24);
    EXPECT_GT(walk.stages.begun["mapping.vergence"], 0);
    EXPECT_THAT(VergencesIn(walk.mapper.TakeEdits()), IsEmpty()) << "seed " << seed;
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
