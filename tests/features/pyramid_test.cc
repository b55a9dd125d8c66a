#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "common/features/corner_detector.h"
#include "common/features/patch_pyramid.h"
#include "common/features/scale_pyramid.h"
#include "tests/features/test_images.h"

namespace pangaea {
namespace {

// An image whose grey value is linear in u and v, so that its value tells the place.
cv::Mat Ramp(int width, int height) {
  cv::Mat image(height, width, CV_8UC1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(x / 2 + y / 4);
  }
  return image;
}

TEST(ImagePyramid, PixelCentresCoincideFromLevelToLevel) {
  const cv::Mat image = Ramp(320, 240);
  ImagePyramid pyramid;
  BuildImagePyramid(image, kMaxPyramidLevels, pyramid);
  for (int l = 1; l < kMaxPyramidLevels; ++l) {
    const cv::Mat& level = pyramid.levels[static_cast<std::size_t>(l)];
    for (int y = 3; y < level.rows - 3; ++y) {
      for (int x = 3; x < level.cols - 3; ++x) {
        EXPECT_NEAR(level.at<std::uint8_t>(y, x), image.at<std::uint8_t>(y << l, x << l), 1.0);
      }
    }
  }
}

TEST(ImagePyramid, OddSizesRoundUp) {
  ImagePyramid pyramid;
  BuildImagePyramid(Ramp(101, 51), 3, pyramid);
  EXPECT_EQ(pyramid.levels[1].size(), cv::Size(51, 26));
  EXPECT_EQ(pyramid.levels[2].size(), cv::Size(26, 13));
}

TEST(ImagePyramid, LevelZeroIsTheImageItself) {
  const cv::Mat image = Ramp(64, 48);
  ImagePyramid pyramid;
  BuildImagePyramid(image, 2, pyramid);
  EXPECT_EQ(pyramid.levels[0].data, image.data);
}

TEST(ScalePyramid, OctavesShowTheSamePlaces) {
  const cv::Mat image = Ramp(320, 240);
  ScalePyramid pyramid;
  pyramid.Build(TexturedImage(400, 300, 1));  // what an earlier image leaves behind must not matter
  pyramid.Build(image);
  for (int o = 0; o < kOctaves; ++o) {
    const cv::Mat& octave = pyramid.octave(o);
    for (const cv::Point2f pixel : {cv::Point2f(60, 40), cv::Point2f(200.0F, 111.0F), cv::Point2f(300, 200)}) {
      const cv::Point2f there = pyramid.ToOctave(pixel, o);
      const cv::Point2f back = pyramid.FromOctave(there, o);
      EXPECT_NEAR(back.x, pixel.x, 1e-3);
      EXPECT_NEAR(back.y, pixel.y, 1e-3);
      const int x = cvRound(there.x), y = cvRound(there.y);
      const double expected = pixel.x / 2.0 + pixel.y / 4.0;
      EXPECT_NEAR(octave.at<std::uint8_t>(y, x), expected, 1.5 + 0.4 * OctaveSigma(o));
    }
  }
}

TEST(ScalePyramid, TheMarginMirrorsTheImage) {
  ScalePyramid pyramid;
  pyramid.Build(TexturedImage(160, 120, 2));
  for (int o = 0; o < kOctaves; ++o) {
    const cv::Mat& octave = pyramid.octave(o);
    EXPECT_EQ(static_cast<int>(octave.step), pyramid.stride());
    const std::uint8_t* row = octave.ptr<std::uint8_t>(5);
    EXPECT_EQ(row[-7], row[7]);
    EXPECT_EQ(row[octave.cols - 1 + 7], row[octave.cols - 1 - 7]);
  }
}

// By the definition: some 9 neighbours in a row on the circle all differ by more than the threshold to one side.
int ScoreByDefinition(const cv::Mat& image, int x, int y) {
  static constexpr int kCircle[16][2] = {{0, -3}, {1, -3}, {2, -2}, {3, -1}, {3, 0},  {3, 1},   {2, 2},   {1, 3},
                                         {0, 3},  {-1, 3}, {-2, 2}, {-3, 1}, {-3, 0}, {-3, -1}, {-2, -2}, {-1, -3}};
  int best = 0;
  for (int first = 0; first < 16; ++first) {
    int brighter = 255, darker = 255;
    for (int i = 0; i < 9; ++i) {
      const int* offset = kCircle[(first + i) % 16];
      const int difference = image.at<std::uint8_t>(y + offset[1], x + offset[0]) - image.at<std::uint8_t>(y, x);
      brighter = std::min(brighter, difference);
      darker = std::min(darker, -difference);
    }
    best = std::max({best, brighter, darker});
  }
  return best;
}

TEST(CornerDetector, FindsExactlyTheMaximaOfTheScoreByItsDefinition) {
  const cv::Mat image = TexturedImage(93, 70, 3, 3);
  constexpr int kThreshold = 12, kBorder = 5;
  cv::Mat scores(image.size(), CV_32SC1, cv::Scalar(0));
  for (int y = kBorder; y < image.rows - kBorder; ++y) {
    for (int x = kBorder; x < image.cols - kBorder; ++x) {
      const int score = ScoreByDefinition(image, x, y);
      scores.at<int>(y, x) = score > kThreshold ? score : 0;
    }
  }
  std::vector<Corner> expected, found;
  for (int y = kBorder; y < image.rows - kBorder; ++y) {
    for (int x = kBorder; x < image.cols - kBorder; ++x) {
      const int score = scores.at<int>(y, x);
      bool best = score > 0;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const bool before = dy < 0 || (dy == 0 && dx < 0);
          const int other = scores.at<int>(y + dy, x + dx);
          if ((dx != 0 || dy != 0) && (before ? other >= score : other > score)) best = false;
        }
      }
      if (best)
        expected.push_back(
            {static_cast<std::int16_t>(x), static_cast<std::int16_t>(y), static_cast<std::uint8_t>(score)});
    }
  }
  CornerDetector().Detect(image, kThreshold, kBorder, found);
  ASSERT_GT(expected.size(), 20U);
  EXPECT_EQ(found, expected);
}

}  // namespace
}  // namespace pangaea
