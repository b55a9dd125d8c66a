#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "agent/absorption/absorption.h"
#include "agent/mapping/guest_rules.h"
#include "agent/mapping/keyframe_culling.h"
#include "agent/mapping/keyframe_insertion.h"
#include "agent/mapping/local_bundle_adjustment.h"
#include "tests/agent/mapping_wall_map.h"

namespace pangaea::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr SessionId kGuest = 9;

// The first two keyframes of a wall map, which a correction has placed.
class CorrectedWall : public WallMap {
 protected:
  void Correct(std::uint32_t counter) {
    const Keyframe& keyframe = Get(counter);
    MoveKeyframes edit{{{keyframe.id, keyframe.camera_from_map, {}, {}}}, 5};
    if (keyframe.parent.valid()) {
      const Rigid3d& parent_from_map = atlas_.FindKeyframe(keyframe.parent)->camera_from_map;
      edit.keyframes[0].camera_from_reference = keyframe.camera_from_map * parent_from_map.Inverse();
    }
    Do(atlas_, {edit});
  }
};

TEST_F(CorrectedWall, WhatACorrectionPlacedIsHeldInBundleAdjustment) {
  Build({0.0, 0.2, 0.4}, true);
  Correct(1);
  Correct(2);
  Do(atlas_, {MoveKeyframes{{{Kf(3), At(0.42, 0.01) * At(0.2).Inverse()}}}});
  const AdjustmentWindow window = ChooseAdjustmentWindow(atlas_, Kf(3), {});
  EXPECT_THAT(window.free, ElementsAre(Kf(3)));
  EXPECT_THAT(window.landmarks, IsEmpty());
  EXPECT_EQ(window.held.size(), points_.size());
  const LocalAdjustment adjustment = AdjustLocalMap(atlas_, window, {}, {}, {});
  ASSERT_EQ(adjustment.camera_from_map.size(), 1U);
  EXPECT_THAT(adjustment.point_in_map, IsEmpty());
  EXPECT_LT((adjustment.camera_from_map[0].second.translation() - At(0.4).translation()).norm(), 2e-3);
}

TEST_F(CorrectedWall, OfALandmarkThatIsReadOnlyOnlyTheOwnWrongObservationGoes) {
  Build({0.0, 0.2}, true);
  Correct(1);
  Correct(2);
  auto data = See(points_, At(0.4), 3);
  data->features.keypoints[7].u += 12.0F;
  Do(atlas_, {AddKeyframe{.id = Kf(3), .map = kMap, .parent = Kf(2), .camera_from_parent = At(0.2), .data = data}});
  for (std::uint32_t i = 0; i < points_.size(); ++i) Do(atlas_, {AddObservation{Lm(i + 1), Kf(3), i}});
  const LocalAdjustment adjustment = AdjustLocalMap(atlas_, ChooseAdjustmentWindow(atlas_, Kf(3), {}), {}, {}, {});
  ASSERT_EQ(adjustment.removals.size(), 1U);
  const auto* removal = std::get_if<RemoveObservation>(&adjustment.removals.front());
  ASSERT_NE(removal, nullptr);
  EXPECT_EQ(removal->landmark, Lm(8));
}

TEST_F(CorrectedWall, AKeyframeThatACorrectionPlacedIsNotCulled) {
  std::vector<double> places;
  for (int i = 0; i < 12; ++i) places.push_back(0.05 * i);
  Build(places, true);
  ASSERT_TRUE(FindRedundantKeyframe(atlas_, Get(12), {}, 100.0, {}));
  EXPECT_EQ(FindRedundantKeyframe(atlas_, Get(12), {}, 100.0, {}), Kf(2));
  Correct(2);
  EXPECT_NE(FindRedundantKeyframe(atlas_, Get(12), {}, 100.0, {}), Kf(2));
}

TEST_F(WallMap, TheParentOfANewKeyframeIsOneOfItsSession) {
  Build({0.0, 0.2}, true);
  const KeyframeId guest{kGuest, 1};
  Do(atlas_,
     {AddKeyframe{
         .id = guest, .map = kMap, .parent = Kf(1), .camera_from_parent = At(0.3), .data = See(points_, At(0.3), 7)}});
  for (std::uint32_t i = 0; i < points_.size(); ++i) Do(atlas_, {AddObservation{Lm(i + 1), guest, i}});
  // The guest sees more of what the candidate sees than the session's own keyframes do.
  for (std::uint32_t i = 0; i < 20; ++i)
    Do(atlas_, {RemoveObservation{Lm(i + 1), Kf(1)}, RemoveObservation{Lm(i + 1), Kf(2)}});
  KeyframeCandidate candidate;
  candidate.id = Kf(3);
  candidate.map = kMap;
  candidate.data = See(points_, At(0.32), 8);
  candidate.reference = Kf(1);
  candidate.camera_from_reference = At(0.32);
  for (std::uint32_t i = 0; i < points_.size(); ++i) candidate.landmarks.push_back(Lm(i + 1));
  const auto edits = InsertKeyframe(atlas_, candidate, {});
  ASSERT_THAT(edits, Not(IsEmpty()));
  EXPECT_EQ(std::get<AddKeyframe>(edits.front()).parent.session, kSession);
}

TEST_F(WallMap, OfTwoLandmarksThatBecomeOneTheGuestIsKept) {
  Build({0.0, 0.2}, true);
  const KeyframeId guest{kGuest, 1};
  const LandmarkId theirs{kGuest, 1};
  const LandmarkId theirs_too{kGuest, 2};
  Do(atlas_,
     {AddKeyframe{
          .id = guest, .map = kMap, .parent = Kf(1), .camera_from_parent = At(0.3), .data = See(points_, At(0.3), 7)},
      AddLandmark{theirs, guest, 0, {0, 0, 3}}, AddLandmark{theirs_too, guest, 1, {0, 0, 3}}});
  const auto allowed =
      RespectOthers(atlas_, kSession,
                    {FuseLandmarks{Lm(1), theirs}, FuseLandmarks{theirs, theirs_too}, FuseLandmarks{theirs, Lm(2)},
                     AddObservation{Lm(5), guest, 5}, AddObservation{theirs, Kf(2), 5}, FuseLandmarks{Lm(3), Lm(4)}});
  ASSERT_EQ(allowed.size(), 4U);
  EXPECT_EQ(std::get<FuseLandmarks>(allowed[0]).kept, theirs);
  EXPECT_EQ(std::get<FuseLandmarks>(allowed[0]).absorbed, Lm(1));
  EXPECT_EQ(std::get<FuseLandmarks>(allowed[1]).kept, theirs);
  EXPECT_EQ(std::get<AddObservation>(allowed[2]).keyframe, Kf(2));
  EXPECT_EQ(std::get<FuseLandmarks>(allowed[3]).kept, Lm(3));
}

}  // namespace
}  // namespace pangaea::testing
