#include "agent/tracking/recent_keyframes.h"

#include <gtest/gtest.h>

#include "tests/agent/tracking/keyframe_chain.h"

namespace pangaea {
namespace {

// Keyframes 1 to `last`, each a metre further than the one before.
RecentKeyframes Made(std::uint32_t last, std::size_t most = 10) {
  ImagePyramid image;
  BuildImagePyramid(cv::Mat(8, 8, CV_8UC1, cv::Scalar(0)), 2, image);
  RecentKeyframes recent(most);
  for (std::uint32_t i = 1; i <= last; ++i) {
    recent.Add(Kept(i), image, i == 1 ? KeyframeId{} : Kept(i - 1), i == 1 ? Rigid3d() : At(1.0), {1.0});
  }
  return recent;
}

TEST(RecentKeyframes, OneIsUnderWayUntilTheMapHasTheNewest) {
  EXPECT_FALSE(RecentKeyframes(10).IsOneUnderWay(Atlas{}));
  const RecentKeyframes recent = Made(2);
  EXPECT_TRUE(recent.IsOneUnderWay(Chain(1)));
  EXPECT_FALSE(recent.IsOneUnderWay(Chain(2)));
}

TEST(RecentKeyframes, TheNewestHasArrivedWhereItWasTracked) {
  const RecentKeyframes recent = Made(2);
  EXPECT_FALSE(recent.NewestTrackedAgainst(Kept(1), Chain(1)).valid()) << "it is under way";
  EXPECT_EQ(recent.NewestTrackedAgainst(Kept(1), Chain(2)), Kept(2));
  EXPECT_FALSE(recent.NewestTrackedAgainst(Kept(7), Chain(2)).valid()) << "the camera has another reference by now";
  EXPECT_FALSE(RecentKeyframes(10).NewestTrackedAgainst({}, Chain(2)).valid());
}

TEST(RecentKeyframes, ThePoseOfOneUnderWayIsKnownOnceItsReferenceIs) {
  const RecentKeyframes recent = Made(3);
  EXPECT_TRUE(recent.PosesUnderWay(Atlas{}).empty());
  const auto poses = recent.PosesUnderWay(Chain(1));
  ASSERT_EQ(poses.size(), 1U) << "the third hangs below one that is under way itself";
  EXPECT_LT((poses[0] * At(1.0).Inverse()).Log().norm(), 1e-12);
  EXPECT_TRUE(recent.PosesUnderWay(Chain(3)).empty());
}

TEST(RecentKeyframes, WhereTheMapWasScaledMeanwhileTheWayToTheReferenceIsToo) {
  Atlas atlas = Chain(1);
  Move(Kept(1), At(0.0), 3.0, atlas);
  const auto poses = Made(2).PosesUnderWay(atlas);
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_LT((poses[0] * At(3.0).Inverse()).Log().norm(), 1e-12);
}

TEST(RecentKeyframes, TheNewestOfTheMapIsOneUnderWayOrOneThatItHas) {
  const RecentKeyframes recent = Made(2);
  const auto under_way = recent.NewestIn(kMap, kSession, Chain(1));
  ASSERT_TRUE(under_way);
  EXPECT_EQ(under_way->id, Kept(2));
  EXPECT_FALSE(under_way->scale);
  EXPECT_LT((under_way->camera_from_map * At(1.0).Inverse()).Log().norm(), 1e-12);
  const auto known = recent.NewestIn(kMap, kSession, Chain(2));
  ASSERT_TRUE(known && known->scale);
  EXPECT_EQ(known->id, Kept(2));
  EXPECT_FALSE(recent.NewestIn({kSession, 9}, kSession, Chain(2)));
}

TEST(RecentKeyframes, TheOldestGivesWay) {
  const auto place = Made(3, 2).NewestIn(kMap, kSession, Chain(1));
  ASSERT_TRUE(place);
  EXPECT_EQ(place->id, Kept(2)) << "the third hangs below one that is under way itself";
  EXPECT_FALSE(Made(3, 1).NewestIn(kMap, kSession, Chain(1)));
}

}  // namespace
}  // namespace pangaea
