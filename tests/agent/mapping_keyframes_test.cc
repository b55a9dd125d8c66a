#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "agent/mapping/keyframe_culling.h"
#include "agent/mapping/keyframe_insertion.h"
#include "agent/mapping/local_mapping_options.h"
#include "agent/mapping/neighbourhood.h"
#include "tests/agent/mapping_wall_map.h"

namespace pangaea::testing {
namespace {

using ::testing::ElementsAre;

TEST_F(WallMap, CandidateHangsBelowTheKeyframeThatSharesMostLandmarks) {
  Build({0.0, 0.1, 0.2}, true);
  // Keyframe 3 loses a few landmarks, so 2 is the newest of those that share all.
  for (std::uint32_t i = 1; i <= 5; ++i) Do(atlas_, {RemoveObservation{Lm(i), Kf(3)}});
  KeyframeCandidate candidate{.id = Kf(4),
                              .map = kMap,
                              .data = See(points_, At(0.3), 4),
                              .reference = Kf(3),
                              .camera_from_reference = At(0.31) * At(0.2).Inverse(),
                              .landmarks = {}};
  for (std::uint32_t i = 0; i < points_.size(); ++i) candidate.landmarks.push_back(Lm(i + 1));
  Do(atlas_, InsertKeyframe(atlas_, candidate, {}));
  EXPECT_EQ(Get(4).parent, Kf(2));
  // The pose was refined on the landmarks: the tracked one was a centimetre off.
  EXPECT_NEAR(Get(4).camera_from_map.translation().x(), -0.3, 1e-3);
}

TEST_F(WallMap, CandidateOfACulledReferenceEntersAtTheRightPlace) {
  Build({0.0, 0.1, 0.2}, true);
  Do(atlas_, {RemoveKeyframe{Kf(3)}});
  const KeyframeCandidate candidate{.id = Kf(4),
                                    .map = kMap,
                                    .data = See({}, At(0.5), 4),
                                    .reference = Kf(3),
                                    .camera_from_reference = At(0.5) * At(0.2).Inverse(),
                                    .landmarks = {}};
  Do(atlas_, InsertKeyframe(atlas_, candidate, {}));
  EXPECT_EQ(Get(4).parent, Kf(2));
  EXPECT_NEAR(Get(4).camera_from_map.translation().x(), -0.5, 1e-9);
}

TEST_F(WallMap, ALandmarkTrackedTwiceIsObservedOnceAndAFusedOneUnderItsNewName) {
  Build({0.0, 0.1}, true);
  auto data = See(points_, At(0.2), 3);
  data->features.keypoints.push_back(data->features.keypoints[0]);
  data->features.descriptors.push_back(data->features.descriptors[0]);
  Do(atlas_, {RemoveObservation{Lm(2), Kf(2)}, AddLandmark{Lm(100), Kf(2), 1, At(0.1) * points_[1]},
              FuseLandmarks{Lm(2), Lm(100)}, RemoveLandmark{Lm(3)}});
  KeyframeCandidate candidate{.id = Kf(3),
                              .map = kMap,
                              .data = data,
                              .reference = Kf(2),
                              .camera_from_reference = At(0.1),
                              .landmarks = std::vector<LandmarkId>(points_.size() + 1)};
  candidate.landmarks[0] = Lm(1);
  candidate.landmarks[1] = Lm(100);  // fused meanwhile
  candidate.landmarks[2] = Lm(3);    // culled meanwhile
  candidate.landmarks.back() = Lm(1);
  Do(atlas_, InsertKeyframe(atlas_, candidate, {}));
  EXPECT_EQ(Get(3).landmarks[0], Lm(1));
  EXPECT_EQ(Get(3).landmarks[1], Lm(2));
  EXPECT_FALSE(Get(3).landmarks[2].valid());
  EXPECT_FALSE(Get(3).landmarks.back().valid());
}

TEST_F(WallMap, AKeyframeWhoseLandmarksEnoughOthersSeeIsRedundant) {
  Build({0.0, 0.1, 0.2, 0.3, 0.4, 0.5}, true);
  const KeyframeCullingOptions options{.redundant_ratio = 0.9, .other_observers = 3, .newest_kept = 3};
  EXPECT_EQ(FindRedundantKeyframe(atlas_, Get(6), {}, 40.0, options), Kf(2));
  EXPECT_EQ(FindRedundantKeyframe(atlas_, Get(6), {Kf(2)}, 40.0, options), Kf(3));
  // Six observers each: with three others asked for it goes, with six it does not.
  EXPECT_FALSE(FindRedundantKeyframe(atlas_, Get(6), {}, 40.0, {.other_observers = 6}).has_value());
}

TEST_F(WallMap, AKeyframeThatLooksAtTheSamePlaceIsANeighbourWithoutSharedLandmarks) {
  Build({0.0, 0.1}, true);
  Do(atlas_,
     {AddKeyframe{
         .id = Kf(3), .map = kMap, .parent = Kf(2), .camera_from_parent = At(0.0), .data = See(points_, At(0.1), 3)}});
  NeighbourhoodOptions options{.first = 5, .second_of_each = 0, .overlapping = 2};
  EXPECT_THAT(Neighbourhood(atlas_, Get(3), options), ElementsAre(Kf(2), Kf(1)));
  options.overlapping = 0;
  EXPECT_THAT(Neighbourhood(atlas_, Get(3), options), ElementsAre(Kf(2)));  // its parent
}

TEST(LocalMappingOptions, DefaultsAreInRangeAndANonsenseValueIsNamed) {
  LocalMappingOptions options;
  EXPECT_TRUE(options.Check().has_value());
  options.creation.max_ratio = 1.5;
  ASSERT_FALSE(options.Check().has_value());
  EXPECT_THAT(options.Check().error().message, ::testing::HasSubstr("creation.max_ratio"));
  options = {};
  options.noise.pixel_sigma = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(options.Check().has_value());
}

}  // namespace
}  // namespace pangaea::testing
