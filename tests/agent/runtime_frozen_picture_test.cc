#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "agent/runtime/frozen_picture.h"

namespace pangaea {
namespace {

using Verdict = FrozenPicture::Verdict;

cv::Mat Picture(int grey) { return {4, 6, CV_8UC1, cv::Scalar(grey)}; }

TEST(FrozenPicture, APictureThatStopsChangingIsADoubleAtFirstAndThenStuckUntilItChanges) {
  FrozenPicture frozen;
  EXPECT_EQ(frozen.Judge(Picture(1)), Verdict::kNew);
  EXPECT_EQ(frozen.Judge(Picture(2)), Verdict::kNew);
  for (int i = 0; i < FrozenPicture::kMostDoubles; ++i) EXPECT_EQ(frozen.Judge(Picture(2)), Verdict::kDouble);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(frozen.Judge(Picture(2)), Verdict::kStuck);
  EXPECT_EQ(frozen.Judge(Picture(3)), Verdict::kNew);
  EXPECT_EQ(frozen.Judge(Picture(3)), Verdict::kDouble);
}

TEST(FrozenPicture, WhereNothingHasChangedYetEveryPictureIsNew) {
  FrozenPicture frozen;
  for (int i = 0; i < 10; ++i) EXPECT_EQ(frozen.Judge(Picture(1)), Verdict::kNew);
}

TEST(FrozenPicture, OneGreyLevelOfOnePixelIsAChange) {
  FrozenPicture frozen;
  EXPECT_EQ(frozen.Judge(Picture(1)), Verdict::kNew);
  EXPECT_EQ(frozen.Judge(Picture(2)), Verdict::kNew);
  cv::Mat other = Picture(2);
  other.at<unsigned char>(3, 5) = 3;
  EXPECT_EQ(frozen.Judge(other), Verdict::kNew);
}

}  // namespace
}  // namespace pangaea
