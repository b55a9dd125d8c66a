#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "agent/mapping/landmark_culling.h"
#include "agent/mapping/neighbourhood.h"
#include "common/map/covisibility.h"
#include "common/mapping/landmark_search.h"
#include "common/mapping/view_prediction.h"
#include "tests/agent/mapping_wall_map.h"

namespace pangaea::testing {
namespace {

using ::testing::IsEmpty;

TEST_F(WallMap, PredictedViewIsWhereTheKeypointIs) {
  Build({0.0, 0.2}, true);
  const auto view = PredictView(atlas_, *atlas_.FindLandmark(Lm(5)), Viewpoint(Get(2)), 60.0);
  ASSERT_TRUE(view.has_value());
  const Keypoint& keypoint = Get(2).data->features.keypoints[4];
  EXPECT_NEAR(view->measurement.x(), keypoint.u, 0.02);
  EXPECT_NEAR(view->measurement.y(), keypoint.v, 0.02);
  EXPECT_NEAR(view->measurement.z(), keypoint.u_right, 0.02);
  EXPECT_EQ(view->octave, 0);
  EXPECT_EQ(view->nearest.keyframe, Kf(2));
}

TEST_F(WallMap, APatchSeenFromHalfTheDistanceIsPredictedFourOctavesUp) {
  Build({0.0}, true);
  const Landmark& landmark = *atlas_.FindLandmark(Lm(28));
  const Viewpoint nearer(kCamera, At(0.0, 0.0, 1.5));
  const auto view = PredictView(atlas_, landmark, nearer, 60.0);
  ASSERT_TRUE(view.has_value());
  EXPECT_EQ(view->octave, 4);  // 1.2^4 = 2.07
}

TEST_F(WallMap, ALandmarkIsNotPredictedFromBehindOutsideOrTheSide) {
  Build({0.0}, true);
  const Landmark& landmark = *atlas_.FindLandmark(Lm(28));
  EXPECT_FALSE(PredictView(atlas_, landmark, Viewpoint(kCamera, At(0.0, 0.0, 5.0)), 60.0).has_value());
  EXPECT_FALSE(PredictView(atlas_, landmark, Viewpoint(kCamera, At(9.0)), 60.0).has_value());
  const Rigid3d turned(Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitY())),
                       Eigen::Vector3d(-3.0, 0.0, 3.0));
  const Viewpoint from_the_side(kCamera, turned);
  EXPECT_TRUE(PredictView(atlas_, landmark, from_the_side, 120.0).has_value());
  EXPECT_FALSE(PredictView(atlas_, landmark, from_the_side, 60.0).has_value());
}

TEST_F(WallMap, SearchObservesEveryLandmarkThatTheKeyframeShows) {
  Build({0.0}, true);
  Do(atlas_, {AddKeyframe{.id = Kf(2),
                          .map = kMap,
                          .parent = Kf(1),
                          .camera_from_parent = At(0.205),
                          .data = See(points_, At(0.2), 2)}});
  const auto edits = SearchLandmarks(atlas_, Get(2), LandmarksSeenBy(atlas_, {Kf(1)}), {});
  EXPECT_EQ(Count<AddObservation>(edits), points_.size());
  Do(atlas_, edits);
  for (std::uint32_t i = 0; i < points_.size(); ++i) EXPECT_EQ(Get(2).landmarks[i], Lm(i + 1));
  EXPECT_THAT(SearchLandmarks(atlas_, Get(2), LandmarksSeenBy(atlas_, {Kf(1)}), {}), IsEmpty());
}

TEST_F(WallMap, SearchFusesTwoLandmarksOfOneCorner) {
  Build({0.0, 0.1}, true);
  Do(atlas_,
     {AddKeyframe{
         .id = Kf(3), .map = kMap, .parent = Kf(2), .camera_from_parent = At(0.1), .data = See(points_, At(0.2), 3)}});
  for (std::uint32_t i = 0; i < 10; ++i) Do(atlas_, {AddLandmark{Lm(100 + i), Kf(3), i, At(0.2) * points_[i]}});
  const auto edits = SearchLandmarks(atlas_, Get(3), LandmarksSeenBy(atlas_, {Kf(1)}), {});
  EXPECT_EQ(Count<FuseLandmarks>(edits), 10U);
  EXPECT_EQ(Count<AddObservation>(edits), points_.size() - 10);
  Do(atlas_, edits);
  EXPECT_EQ(atlas_.Resolve(Lm(103)), Lm(4));
}

TEST_F(WallMap, LandmarksThatOneKeyframeSeesApartAreNotFused) {
  Build({0.0, 0.1}, true);
  EXPECT_FALSE(FuseIfTheyAgree(atlas_, *atlas_.FindLandmark(Lm(1)), *atlas_.FindLandmark(Lm(2)), 1000.0).has_value());
}

TEST_F(WallMap, ANewLandmarkThatOthersShouldSeeButDoNotFailsItsTrial) {
  Build({0.0, 0.1, 0.2}, false);
  LandmarkTrials trials({.first_verdict_chances = 2, .trial_chances = 3});
  const std::vector<MapEdit> created{AddLandmark{Lm(1), Kf(1), 0, points_[0]},
                                     AddLandmark{Lm(2), Kf(1), 1, points_[1]}};
  Do(atlas_, created);
  trials.Begin(created);
  Do(atlas_, {AddObservation{Lm(2), Kf(2), 1}, AddObservation{Lm(2), Kf(3), 1}});
  trials.CountChances(atlas_, Get(2), 60.0);
  EXPECT_THAT(trials.Judge(atlas_), IsEmpty());
  trials.CountChances(atlas_, Get(3), 60.0);
  const auto verdict = trials.Judge(atlas_);
  ASSERT_EQ(verdict.size(), 1U);
  EXPECT_EQ(std::get<RemoveLandmark>(verdict.front()).id, Lm(1));
}

}  // namespace
}  // namespace pangaea::testing
