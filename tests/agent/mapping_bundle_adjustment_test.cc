#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "agent/mapping/local_bundle_adjustment.h"
#include "agent/mapping/map_strain.h"
#include "common/map/covisibility.h"
#include "tests/agent/mapping_wall_map.h"

namespace pangaea::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST_F(WallMap, BundleAdjustmentMovesTheNewestKeyframeBackAndTheRootNever) {
  Build({0.0, 0.2, 0.4}, true);
  const Rigid3d shifted = At(0.42, 0.01);
  Do(atlas_, {MoveKeyframes{{{Kf(3), shifted * At(0.2).Inverse()}}}});
  const AdjustmentWindow window = ChooseAdjustmentWindow(atlas_, Kf(3), {});
  EXPECT_THAT(window.free, ElementsAre(Kf(2), Kf(3)));
  EXPECT_THAT(window.fixed, ElementsAre(Kf(1)));
  const LocalAdjustment adjustment = AdjustLocalMap(atlas_, window, {}, {}, {});
  ASSERT_EQ(adjustment.camera_from_map.size(), 2U);
  EXPECT_LT((adjustment.camera_from_map[1].second.translation() - At(0.4).translation()).norm(), 2e-3);
  EXPECT_THAT(adjustment.removals, IsEmpty());
}

TEST_F(WallMap, BothBackEndsAgree) {
  Build({0.0, 0.2, 0.4}, true);
  Do(atlas_, {MoveKeyframes{{{Kf(3), At(0.42, 0.01) * At(0.2).Inverse()}}}});
  const AdjustmentWindow window = ChooseAdjustmentWindow(atlas_, Kf(3), {});
  LocalBundleAdjustmentOptions ceres;
  ceres.back_end = BundleAdjustmentBackEnd::kCeres;
  const auto fast_result = AdjustLocalMap(atlas_, window, {}, {}, {});
  const auto ceres_result = AdjustLocalMap(atlas_, window, ceres, {}, {});
  for (std::size_t i = 0; i < fast_result.camera_from_map.size(); ++i) {
    const Rigid3d difference = fast_result.camera_from_map[i].second * ceres_result.camera_from_map[i].second.Inverse();
    EXPECT_LT(difference.Log().norm(), 1e-4);
  }
}

TEST_F(WallMap, AWideWindowComesBackToTheSamePlaces) {
  std::vector<double> places;
  for (std::size_t k = 0; k < kDenseKeyframes + 10; ++k) places.push_back(0.01 * static_cast<double>(k));
  Build(places, true);
  const auto newest = static_cast<std::uint32_t>(places.size());
  for (std::uint32_t k = 2; k <= newest; k += 3) {
    Do(atlas_, {MoveKeyframes{{{Kf(k), At(places[k - 1] + 0.02, 0.01) * At(places[k - 2]).Inverse()}}}});
  }
  LocalBundleAdjustmentOptions options;
  options.window_keyframes = places.size();
  const AdjustmentWindow window = ChooseAdjustmentWindow(atlas_, Kf(newest), options);
  ASSERT_GT(window.free.size(), kDenseKeyframes);
  const LocalAdjustment adjustment = AdjustLocalMap(atlas_, window, options, {}, {});
  for (const auto& [id, camera_from_map] : adjustment.camera_from_map) {
    EXPECT_LT((camera_from_map * At(places[id.counter - 1]).Inverse()).Log().norm(), 2e-3) << id.counter;
  }
}

TEST_F(WallMap, OnlyWhatIsMovedStrainsTheMap) {
  Build({0.0, 0.2, 0.4}, true);
  const std::vector<LandmarkId> landmarks = LandmarksSeenBy(atlas_, {Kf(3)});
  EXPECT_EQ(StrainOf(atlas_, landmarks, 1000, {}).observations, 3 * points_.size());
  EXPECT_EQ(StrainOf(atlas_, landmarks, 1000, {}).contradicting, 0U);
  Do(atlas_, {MoveKeyframes{{{Kf(3), At(0.45) * At(0.2).Inverse()}}}});
  EXPECT_EQ(StrainOf(atlas_, landmarks, 1000, {}).contradicting, points_.size());
  EXPECT_DOUBLE_EQ(StrainOf(atlas_, landmarks, 1000, {}).share(), 1.0 / 3.0);
  EXPECT_EQ(StrainOf(atlas_, landmarks, points_.size() / 2, {}).observations, 3 * points_.size() / 2) << "samples";
  Do(atlas_, {RemoveLandmark{.id = landmarks[0]}});
  EXPECT_EQ(StrainOf(atlas_, landmarks, 1000, {}).contradicting, points_.size() - 1) << "one is gone";
  EXPECT_EQ(StrainOf(atlas_, {}, 1000, {}).share(), 0.0);
}

TEST_F(WallMap, AnObservationThatContradictsTheOthersIsRemoved) {
  Build({0.0, 0.2}, true);
  auto data = See(points_, At(0.4), 3);
  data->features.keypoints[7].u += 12.0F;
  Do(atlas_, {AddKeyframe{.id = Kf(3), .map = kMap, .parent = Kf(2), .camera_from_parent = At(0.2), .data = data}});
  for (std::uint32_t i = 0; i < points_.size(); ++i) Do(atlas_, {AddObservation{Lm(i + 1), Kf(3), i}});
  const LocalAdjustment adjustment = AdjustLocalMap(atlas_, ChooseAdjustmentWindow(atlas_, Kf(3), {}), {}, {}, {});
  EXPECT_DOUBLE_EQ(adjustment.outlier_share, 1.0 / static_cast<double>(3 * points_.size()));
  ASSERT_EQ(adjustment.removals.size(), 1U);
  const auto* removal = std::get_if<RemoveObservation>(&adjustment.removals.front());
  ASSERT_NE(removal, nullptr);
  EXPECT_EQ(removal->landmark, Lm(8));
  EXPECT_EQ(removal->keyframe, Kf(3));
}

TEST_F(WallMap, ALandmarkOfOneKeyframeMovesWithIt) {
  Build({0.0, 0.2}, true);
  auto data = See(points_, At(0.4), 3);
  data->features.keypoints.push_back({.u = 320.0F, .v = 240.0F, .u_right = 300.0F});
  data->features.descriptors.push_back(MakeDescriptor(1000));
  Do(atlas_, {AddKeyframe{.id = Kf(3), .map = kMap, .parent = Kf(2), .camera_from_parent = At(0.22), .data = data}});
  for (std::uint32_t i = 0; i < points_.size(); ++i) Do(atlas_, {AddObservation{Lm(i + 1), Kf(3), i}});
  Do(atlas_, {AddLandmark{Lm(500), Kf(3), static_cast<std::uint32_t>(points_.size()), Eigen::Vector3d(0.0, 0.0, 2.0)}});
  const AdjustmentWindow window = ChooseAdjustmentWindow(atlas_, Kf(3), {});
  EXPECT_THAT(window.carried, ElementsAre(Lm(500)));
  const LocalAdjustment adjustment = AdjustLocalMap(atlas_, window, {}, {}, {});
  const Rigid3d& pose = adjustment.camera_from_map.back().second;
  EXPECT_EQ(adjustment.point_in_map.back().first, Lm(500));
  EXPECT_LT((pose * adjustment.point_in_map.back().second - Eigen::Vector3d(0.0, 0.0, 2.0)).norm(), 1e-9);
}

}  // namespace
}  // namespace pangaea::testing
