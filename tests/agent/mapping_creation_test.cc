#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/mapping/landmark_creation.h"
#include "tests/agent/mapping_wall_map.h"

namespace pangaea::testing {
namespace {

using ::testing::IsEmpty;

TEST_F(WallMap, StereoLandmarksAreCreatedNearByOnlyUnlessTheMapBegins) {
  points_ = Wall(8, 6, 3.0);
  const std::vector<Eigen::Vector3d> far = Wall(8, 6, 6.0);
  points_.insert(points_.end(), far.begin(), far.end());
  Build({0.0}, false);
  LandmarkCreationOptions options{
      .close_depth_baselines = 40.0, .first_depth_baselines = 80.0, .min_close_landmarks = 10};
  EXPECT_EQ(CreateFromStereo(atlas_, Get(1), Lm(1), options).size(), 96U);
  Do(atlas_,
     {AddKeyframe{
         .id = Kf(2), .map = kMap, .parent = Kf(1), .camera_from_parent = At(0.1), .data = See(points_, At(0.1), 2)}});
  const auto edits = CreateFromStereo(atlas_, Get(2), Lm(1), options);
  EXPECT_EQ(edits.size(), 48U);
  Do(atlas_, edits);
  EXPECT_LT((atlas_.FindLandmark(Lm(1))->point_in_map.z() - 3.0), 0.15);
  options.min_close_landmarks = 60;  // twelve more from farther away
  EXPECT_EQ(CreateFromStereo(atlas_, Get(2), Lm(100), options).size(), 12U);
}

TEST_F(WallMap, TriangulationRecoversThePoints) {
  Build({0.0, 0.3}, false);
  const auto edits = CreateByTriangulation(atlas_, Get(2), {Kf(1)}, Lm(1), {}, {});
  EXPECT_EQ(Count<AddLandmark>(edits), points_.size());
  Do(atlas_, edits);
  for (std::uint32_t i = 0; i < points_.size(); ++i) {
    ASSERT_TRUE(Get(2).landmarks[i].valid());
    EXPECT_EQ(Get(1).landmarks[i], Get(2).landmarks[i]);
    EXPECT_LT((atlas_.FindLandmark(Get(2).landmarks[i])->point_in_map - points_[i]).norm(), 0.02);
  }
}

TEST_F(WallMap, WithoutParallaxNothingIsTriangulated) {
  Build({0.0, 0.01}, false);
  EXPECT_THAT(CreateByTriangulation(atlas_, Get(2), {Kf(1)}, Lm(1), {}, {}), IsEmpty());
}

}  // namespace
}  // namespace pangaea::testing
