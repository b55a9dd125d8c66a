#include "common/features/stereo_matcher.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "common/features/orb_extractor.h"
#include "tests/features/test_images.h"

namespace pangaea {
namespace {

constexpr int kWidth = 752, kHeight = 480;
const IdealCamera kCamera{.width = kWidth,
                          .height = kHeight,
                          .focal_x = 450.0,
                          .focal_y = 450.0,
                          .center_x = 375.5,
                          .center_y = 239.5,
                          .baseline = 0.11};

// The plane with disparity d(u, v) = base + slope_u * u + slope_v * v, in pixels of the left image.
struct Plane {
  double base = 0.0, slope_u = 0.0, slope_v = 0.0;
  double At(double u, double v) const { return base + slope_u * u + slope_v * v; }
};

// What the right camera sees of a plane whose left image is `left`, `rows` pixels too low.
cv::Mat RightImage(const cv::Mat& left, const Plane& plane, double rows = 0.0) {
  cv::Mat u(left.size(), CV_32FC1), v(left.size(), CV_32FC1), right;
  for (int y = 0; y < left.rows; ++y) {
    for (int x = 0; x < left.cols; ++x) {
      const double row = y - rows;
      // u - d(u, v) = x
      u.at<float>(y, x) = static_cast<float>((x + plane.base + plane.slope_v * row) / (1.0 - plane.slope_u));
      v.at<float>(y, x) = static_cast<float>(row);
    }
  }
  cv::remap(left, right, u, v, cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
  return right;
}

std::vector<Keypoint> Corners(const cv::Mat& image) { return OrbExtractor().Extract(image).keypoints; }

struct Accuracy {
  double matched = 0.0;  // share of the keypoints that the right camera sees
  double rms = 0.0;      // pixels
};

Accuracy Measure(const std::vector<Keypoint>& keypoints, const Plane& plane) {
  int visible = 0, matched = 0;
  double sum = 0.0;
  for (const Keypoint& k : keypoints) {
    const double disparity = plane.At(k.u, k.v);
    if (k.u - disparity > 30.0 && k.u > 30.0 && k.u < kWidth - 30.0) ++visible;
    if (!k.has_depth()) continue;
    ++matched;
    sum += std::pow(k.u - k.u_right - disparity, 2.0);
  }
  return {static_cast<double>(matched) / visible, std::sqrt(sum / std::max(1, matched))};
}

TEST(StereoOptions, RefuseWhatCannotWork) {
  EXPECT_TRUE(StereoOptions{}.Check().has_value());
  EXPECT_FALSE(StereoOptions{.min_disparity = 0.0}.Check().has_value());
  EXPECT_FALSE(StereoOptions{.uniqueness = 1.5}.Check().has_value());
  EXPECT_FALSE(StereoOptions{.min_correlation = std::nan("")}.Check().has_value());
}

TEST(StereoMatcher, MeasuresFrontalPlanesToAFractionOfAPixel) {
  const cv::Mat left = TexturedImage(kWidth, kHeight, 1);
  std::vector<Keypoint> keypoints = Corners(left);
  for (const double disparity : {3.3, 17.5, 61.8, 120.25}) {
    const Plane plane{.base = disparity};
    StereoMatcher().Match(left, RightImage(left, plane), kCamera, keypoints);
    const Accuracy accuracy = Measure(keypoints, plane);
    EXPECT_GT(accuracy.matched, 0.9) << disparity;
    EXPECT_LT(accuracy.rms, 0.1) << disparity;
  }
}

TEST(StereoMatcher, MeasuresSlantedPlanes) {
  const cv::Mat left = TexturedImage(kWidth, kHeight, 2);
  std::vector<Keypoint> keypoints = Corners(left);
  for (const Plane& plane : {Plane{5.0, 0.0, 0.15}, Plane{10.0, 0.1, 0.0}, Plane{70.0, -0.08, 0.05}}) {
    StereoMatcher().Match(left, RightImage(left, plane), kCamera, keypoints);
    const Accuracy accuracy = Measure(keypoints, plane);
    EXPECT_GT(accuracy.matched, 0.7);
    EXPECT_LT(accuracy.rms, 0.15);
  }
}

TEST(StereoMatcher, ToleratesRowsThatAreOffByAPixel) {
  const cv::Mat left = TexturedImage(kWidth, kHeight, 3);
  std::vector<Keypoint> keypoints = Corners(left);
  const Plane plane{.base = 20.4};
  StereoMatcher().Match(left, RightImage(left, plane, 0.9), kCamera, keypoints);
  const Accuracy accuracy = Measure(keypoints, plane);
  EXPECT_GT(accuracy.matched, 0.8);
  EXPECT_LT(accuracy.rms, 0.15);
}

TEST(StereoMatcher, IsIndifferentToGainOffsetAndNoise) {
  const cv::Mat left = TexturedImage(kWidth, kHeight, 4);
  std::vector<Keypoint> keypoints = Corners(left);
  const Plane plane{.base = 33.7};
  cv::Mat right = RightImage(left, plane), noise(left.size(), CV_16SC1);
  cv::RNG(5).fill(noise, cv::RNG::NORMAL, 12.0, 3.0);
  right.convertTo(right, CV_8UC1, 0.8);
  cv::add(right, noise, right, cv::noArray(), CV_8UC1);
  StereoMatcher().Match(left, right, kCamera, keypoints);
  const Accuracy accuracy = Measure(keypoints, plane);
  EXPECT_GT(accuracy.matched, 0.8);
  EXPECT_LT(accuracy.rms, 0.2);
}

TEST(StereoMatcher, APredictedDepthNarrowsTheSearch) {
  const cv::Mat left = TexturedImage(kWidth, kHeight, 6);
  std::vector<Keypoint> keypoints = Corners(left);
  const Plane plane{.base = 40.0};
  const cv::Mat right = RightImage(left, plane);
  const auto depth = static_cast<float>(kCamera.focal_x * kCamera.baseline / plane.base);
  const std::vector<float> near(keypoints.size(), 1.1F * depth), wrong(keypoints.size(), 10.0F * depth);
  StereoMatcher().Match(left, right, kCamera, keypoints, near);
  EXPECT_GT(Measure(keypoints, plane).matched, 0.9);
  StereoMatcher().Match(left, right, kCamera, keypoints, wrong);
  EXPECT_LT(Measure(keypoints, plane).matched, 0.02);
}

TEST(StereoMatcher, RefusesRepeatedTexture) {
  // The same 24 columns again and again: the true place looks like its neighbours.
  const cv::Mat tile = TexturedImage(24, kHeight, 7);
  cv::Mat left;
  cv::repeat(tile, 1, kWidth / 24 + 1, left);
  left = left(cv::Rect(0, 0, kWidth, kHeight)).clone();
  std::vector<Keypoint> keypoints = Corners(left);
  // Nearer to the left edge the other places are outside of the right image.
  std::erase_if(keypoints, [](const Keypoint& k) { return k.u < 120.0F; });
  ASSERT_GT(keypoints.size(), 100U);
  const StereoStatistics statistics = StereoMatcher().Match(left, RightImage(left, {.base = 12.0}), kCamera, keypoints);
  EXPECT_EQ(statistics.matched, 0);
}

TEST(StereoMatcher, RefusesEdgesAlongTheRow) {
  cv::Mat left(kHeight, kWidth, CV_8UC1);
  for (int y = 0; y < kHeight; ++y) left.row(y).setTo((y / 20) % 2 == 0 ? 40 : 200);
  std::vector<Keypoint> keypoints(50);
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    keypoints[i].u = 200.0F + static_cast<float>(i);
    keypoints[i].v = 40.0F + 7.0F * static_cast<float>(i);
  }
  const StereoStatistics statistics = StereoMatcher().Match(left, left, kCamera, keypoints);
  EXPECT_EQ(statistics.no_texture, 50);
  for (const Keypoint& keypoint : keypoints) EXPECT_EQ(keypoint.u_right, -1.0F);
}

TEST(StereoMatcher, UnrelatedImagesGiveAlmostNoMatches) {
  const cv::Mat left = TexturedImage(kWidth, kHeight, 8, 3), right = TexturedImage(kWidth, kHeight, 9, 3);
  std::vector<Keypoint> keypoints = Corners(left);
  const StereoStatistics statistics = StereoMatcher().Match(left, right, kCamera, keypoints);
  EXPECT_LT(statistics.matched, static_cast<int>(keypoints.size()) / 50);
}

TEST(StereoMatcher, WhatIsTooFarAwayStaysWithoutDepth) {
  const cv::Mat left = TexturedImage(kWidth, kHeight, 10);
  std::vector<Keypoint> keypoints = Corners(left);
  const StereoStatistics statistics = StereoMatcher().Match(left, left, kCamera, keypoints);
  EXPECT_EQ(statistics.matched, 0);
  EXPECT_GT(statistics.out_of_range, static_cast<int>(keypoints.size()) * 9 / 10);
}

TEST(StereoMatcher, KeypointsAtTheImagesEdgeAreLeftAlone) {
  const cv::Mat left = TexturedImage(kWidth, kHeight, 11);
  std::vector<Keypoint> keypoints(4);
  keypoints[1].u = kWidth - 1.0F;
  keypoints[2].v = kHeight - 1.0F;
  keypoints[3] = {.u = -3.0F, .v = 1e6F};
  const StereoStatistics statistics = StereoMatcher().Match(left, left, kCamera, keypoints);
  EXPECT_EQ(statistics.out_of_range, 4);
}

TEST(StereoMatcher, AnswersAreQuantisedAndRepeatable) {
  const cv::Mat left = TexturedImage(kWidth, kHeight, 12);
  const cv::Mat right = RightImage(left, {.base = 9.0});
  std::vector<Keypoint> first = Corners(left), second = first;
  StereoMatcher fresh, used;
  used.Match(right, left, kCamera, second);
  const StereoStatistics statistics = fresh.Match(left, right, kCamera, first);
  used.Match(left, right, kCamera, second);
  EXPECT_EQ(first, second);
  int matched = 0;
  for (const Keypoint& k : first) {
    if (!k.has_depth()) continue;
    ++matched;
    EXPECT_EQ(k.u_right, QuantizePixel(k.u_right));
    EXPECT_GE(k.u - k.u_right, StereoOptions{}.min_disparity);
  }
  EXPECT_EQ(matched, statistics.matched);
}

}  // namespace
}  // namespace pangaea
