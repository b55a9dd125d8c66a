#include "common/features/orb_extractor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "common/features/matching.h"
#include "tests/features/test_images.h"

namespace pangaea {
namespace {

std::vector<FixedPoint> SomeFixedPoints() {
  std::vector<FixedPoint> points;
  for (int i = 0; i < 40; ++i) {
    points.push_back({20.3F + 17.7F * static_cast<float>(i), 30.7F + 10.1F * static_cast<float>(i), i % kOctaves});
  }
  return points;
}

// Share of keypoints of `features` within a border that are found again, by mutual best descriptor, where `moved`
// (affine) takes them.
double ShareFoundAgain(const Features& features, const Features& again, const cv::Matx23d& moved, cv::Size size) {
  int visible = 0, found = 0;
  std::vector<bool> should(features.keypoints.size(), false);
  const auto move = [&](const Keypoint& k) {
    return cv::Point2d(moved(0, 0) * k.u + moved(0, 1) * k.v + moved(0, 2),
                       moved(1, 0) * k.u + moved(1, 1) * k.v + moved(1, 2));
  };
  for (std::size_t i = 0; i < features.keypoints.size(); ++i) {
    const cv::Point2d p = move(features.keypoints[i]);
    should[i] = p.x > 40 && p.y > 40 && p.x < size.width - 40 && p.y < size.height - 40;
    visible += should[i] ? 1 : 0;
  }
  for (const Match& match : MatchBruteForce(features.descriptors, again.descriptors, {.max_ratio = 0.9})) {
    const Keypoint& k = again.keypoints[match.train];
    const cv::Point2d offset = move(features.keypoints[match.query]) - cv::Point2d(k.u, k.v);
    if (should[match.query] && cv::norm(offset) < 2.0 * OctaveSigma(k.octave)) ++found;
  }
  return static_cast<double>(found) / visible;
}

TEST(OrbOptions, RefuseWhatCannotWork) {
  EXPECT_TRUE(OrbOptions{}.Check().has_value());
  EXPECT_FALSE(OrbOptions{.features = 0}.Check().has_value());
  EXPECT_FALSE((OrbOptions{.high_threshold = 5, .low_threshold = 7}.Check().has_value()));
  EXPECT_FALSE(OrbOptions{.min_distance = std::nanf("")}.Check().has_value());
}

TEST(OrbExtractor, GivesTheWantedNumberOnARichImage) {
  const Features features = OrbExtractor().Extract(TexturedImage(752, 480, 1));
  EXPECT_EQ(features.keypoints.size(), 1000U);
  EXPECT_EQ(features.descriptors.size(), 1000U);
  std::set<int> octaves;
  for (const Keypoint& keypoint : features.keypoints) {
    octaves.insert(keypoint.octave);
    EXPECT_EQ(keypoint.u, QuantizePixel(keypoint.u));
    EXPECT_FALSE(keypoint.has_depth());
  }
  EXPECT_EQ(octaves.size(), static_cast<std::size_t>(kOctaves));
}

TEST(OrbExtractor, FindsNothingOnAGreyWall) {
  EXPECT_TRUE(OrbExtractor().Extract(cv::Mat(480, 752, CV_8UC1, cv::Scalar(90))).keypoints.empty());
}

TEST(OrbExtractor, AcceptsImagesSmallerThanAPatch) {
  const std::vector<FixedPoint> fixed = {{1.0F, 1.0F, 7}};
  EXPECT_EQ(OrbExtractor().Extract(TexturedImage(20, 12, 2), fixed).descriptors.size(), 1U);
}

TEST(OrbExtractor, FixedPointsComeFirstAtTheirPlaces) {
  const std::vector<FixedPoint> fixed = SomeFixedPoints();
  const Features features = OrbExtractor().Extract(TexturedImage(752, 480, 3), fixed);
  ASSERT_EQ(features.keypoints.size(), 1000U);
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    EXPECT_EQ(features.keypoints[i].u, QuantizePixel(fixed[i].u));
    EXPECT_EQ(features.keypoints[i].v, QuantizePixel(fixed[i].v));
    EXPECT_EQ(features.keypoints[i].octave, fixed[i].octave);
  }
}

TEST(OrbExtractor, FixedPointsAtTheImagesEdgeKeepTheirSlot) {
  const std::vector<FixedPoint> fixed = {{0.0F, 0.0F, 0}, {751.0F, 479.0F, 7}, {-0.4F, 479.4F, 3}, {100.0F, 100.0F, 0}};
  const Features features = OrbExtractor().Extract(TexturedImage(752, 480, 4), fixed);
  EXPECT_FLOAT_EQ(features.keypoints[1].u, 751.0F);
  EXPECT_FLOAT_EQ(features.keypoints[3].v, 100.0F);
  EXPECT_EQ(features.keypoints.size(), features.descriptors.size());
}

TEST(OrbExtractor, MoreFixedPointsThanFeaturesAreAllKept) {
  const std::vector<FixedPoint> fixed = SomeFixedPoints();
  const Features features = OrbExtractor({.features = 10}).Extract(TexturedImage(752, 480, 5), fixed);
  EXPECT_EQ(features.keypoints.size(), fixed.size());
}

TEST(OrbExtractor, NewCornersKeepTheirDistance) {
  const OrbOptions options;
  const std::vector<FixedPoint> fixed = SomeFixedPoints();
  const Features features = OrbExtractor(options).Extract(TexturedImage(752, 480, 6), fixed);
  for (std::size_t i = fixed.size(); i < features.keypoints.size(); ++i) {
    const Keypoint& corner = features.keypoints[i];
    const double reach = options.min_distance * OctaveSigma(corner.octave) - 0.1;  // quantisation
    for (std::size_t j = 0; j < i; ++j) {
      const Keypoint& other = features.keypoints[j];
      if (j >= fixed.size() && other.octave != corner.octave) continue;
      EXPECT_GE(std::hypot(corner.u - other.u, corner.v - other.v), reach);
    }
  }
}

TEST(OrbExtractor, AFixedPointIsDescribedAsTheCornerThatWasFoundThere) {
  const cv::Mat image = TexturedImage(752, 480, 7);
  OrbExtractor extractor;
  const Features found = extractor.Extract(image);
  std::vector<FixedPoint> fixed;
  for (const Keypoint& keypoint : found.keypoints) fixed.push_back({keypoint.u, keypoint.v, keypoint.octave});
  EXPECT_EQ(extractor.Extract(image, fixed), found);
}

TEST(OrbExtractor, SpreadsOverAnImageWithOneStrongCorner) {
  // The left half has ten times the contrast of the right one: by score alone it would take everything.
  cv::Mat image = TexturedImage(752, 480, 8);
  cv::Mat right = image(cv::Rect(376, 0, 376, 480));
  right.convertTo(right, CV_8UC1, 0.4, 80.0);
  const Features features = OrbExtractor().Extract(image);
  const auto in_right =
      std::count_if(features.keypoints.begin(), features.keypoints.end(), [](const Keypoint& k) { return k.u > 376; });
  EXPECT_GT(in_right, static_cast<std::ptrdiff_t>(features.keypoints.size()) / 4);
}

TEST(OrbExtractor, FillsWhereFixedPointsLeaveRoom) {
  std::vector<FixedPoint> fixed;
  for (int i = 0; i < 300; ++i) {
    fixed.push_back({10.0F + 17.0F * static_cast<float>(i % 20), 10.0F + 31.0F * static_cast<float>(i / 20), i % 3});
  }
  const Features features = OrbExtractor({.features = 500}).Extract(TexturedImage(752, 480, 9), fixed);
  ASSERT_EQ(features.keypoints.size(), 500U);
  const auto new_in_right = std::count_if(features.keypoints.begin() + 300, features.keypoints.end(),
                                          [](const Keypoint& k) { return k.u > 360; });
  EXPECT_GT(new_in_right, 120);
}

TEST(OrbExtractor, GivesTheSameForTheSameWhateverCameBefore) {
  const cv::Mat image = TexturedImage(640, 400, 10);
  OrbExtractor fresh, used;
  used.Extract(TexturedImage(752, 480, 11));
  used.Extract(TexturedImage(320, 240, 12));
  EXPECT_EQ(fresh.Extract(image), used.Extract(image));
}

TEST(OrbExtractor, DescriptorsSurviveTurnsOfTheImage) {
  const cv::Mat image = TexturedImage(480, 480, 13);
  OrbExtractor extractor;
  const Features before = extractor.Extract(image);
  for (const double degrees : {30.0, 90.0, 171.0}) {
    const cv::Matx23d moved = cv::getRotationMatrix2D({239.5F, 239.5F}, degrees, 1.0);
    cv::Mat turned;
    cv::warpAffine(image, turned, moved, image.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT_101);
    EXPECT_GT(ShareFoundAgain(before, extractor.Extract(turned), moved, image.size()), 0.4) << degrees;
  }
}

TEST(OrbExtractor, AnglesTurnWithTheImage) {
  const cv::Mat image = TexturedImage(480, 480, 14);
  OrbExtractor extractor;
  const Features before = extractor.Extract(image);
  cv::Mat turned;
  cv::rotate(image, turned, cv::ROTATE_90_CLOCKWISE);
  std::vector<FixedPoint> fixed;
  for (const Keypoint& k : before.keypoints) {
    if (k.octave == 0) fixed.push_back({479.0F - k.v, k.u, 0});
  }
  const Features after = extractor.Extract(turned, fixed);
  std::size_t i = 0;
  for (std::size_t j = 0; j < before.keypoints.size(); ++j) {
    if (before.keypoints[j].octave != 0) continue;
    const int turn = static_cast<std::int8_t>(after.keypoints[i].angle - before.keypoints[j].angle - 64);
    EXPECT_LE(std::abs(turn), 6);  // the pixel nearest to a half may be another after the turn
    ++i;
  }
}

TEST(OrbExtractor, DescriptorsSurviveAChangeOfScale) {
  const cv::Mat image = TexturedImage(752, 480, 15, 8);
  OrbExtractor extractor;
  const Features before = extractor.Extract(image);
  for (const double scale : {0.7, 1.3}) {
    const cv::Matx23d moved(scale, 0.0, 0.5 * scale - 0.5, 0.0, scale, 0.5 * scale - 0.5);
    cv::Mat scaled;
    cv::resize(image, scaled, {}, scale, scale, cv::INTER_AREA);
    EXPECT_GT(ShareFoundAgain(before, extractor.Extract(scaled), moved, scaled.size()), 0.3) << scale;
  }
}

TEST(OrbExtractor, DescriptorsOfUnrelatedCornersDifferInHalfOfTheBits) {
  const Features features = OrbExtractor().Extract(TexturedImage(752, 480, 16));
  double sum = 0.0;
  for (std::size_t i = 0; i + 500 < features.descriptors.size(); ++i) {
    sum += HammingDistance(features.descriptors[i], features.descriptors[i + 500]);
  }
  EXPECT_NEAR(sum / 500.0, 128.0, 15.0);
}

}  // namespace
}  // namespace pangaea
