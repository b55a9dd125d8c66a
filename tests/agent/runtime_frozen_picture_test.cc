#include "agent/runtime/frozen_picture.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace pangaea {
namespace {

cv::Mat Picture(int grey) { return {4, 6, CV_8UC1, cv::Scalar(grey)}; }

TEST(FrozenPicture, APictureThatStopsChangingIsFrozenUntilItChangesAgain) {
  FrozenPicture frozen;
  EXPECT_FALSE(frozen.Repeats(Picture(1)));
  EXPECT_FALSE(frozen.Repeats(Picture(2)));
  EXPECT_TRUE(frozen.Repeats(Picture(2)));
  EXPECT_TRUE(frozen.Repeats(Picture(2)));
  EXPECT_FALSE(frozen.Repeats(Picture(3)));
  EXPECT_TRUE(frozen.Repeats(Picture(3)));
}

TEST(FrozenPicture, WhereNothingHasChangedYetNothingIsFrozen) {
  FrozenPicture frozen;
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(frozen.Repeats(Picture(1)));
}

TEST(FrozenPicture, OneGreyLevelOfOnePixelIsAChange) {
  FrozenPicture frozen;
  EXPECT_FALSE(frozen.Repeats(Picture(1)));
  EXPECT_FALSE(frozen.Repeats(Picture(2)));
  cv::Mat other = Picture(2);
  other.at<unsigned char>(3, 5) = 3;
  EXPECT_FALSE(frozen.Repeats(other));
}

}  // namespace
}  // namespace pangaea
