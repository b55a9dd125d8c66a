#include "common/sensor/image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <random>
#include <span>

#include "common/base/text.h"
#include "common/sensor/png.h"
#include "common/sensor/png_encoder.h"
#include "tests/sensor/temporary_folder.h"

namespace pangaea {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;

// Smooth shapes with a little noise, so that an encoder tries all its filters.
cv::Mat Picture(int width, int height) {
  std::mt19937 random(width);
  cv::Mat image(height, width, CV_8UC1);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const bool noisy = v > height / 2;
      image.at<std::uint8_t>(v, u) =
          static_cast<std::uint8_t>(2 * u + 3 * v + u * v / 7 + (noisy ? static_cast<int>(random() % 9) : 0));
    }
  }
  return image;
}

class ImageFile : public ::testing::Test {
 protected:
  std::filesystem::path Write(const std::string& name, const cv::Mat& image, const std::vector<int>& options = {}) {
    const auto path = folder_.path() / name;
    EXPECT_TRUE(cv::imwrite(path.string(), image, options));
    return path;
  }
  std::string Bytes(const std::filesystem::path& path) { return *ReadTextFile(path); }
  std::string MessageFor(const std::filesystem::path& path) {
    const auto image = ReadGrayImage(path, {64, 48});
    if (image) return "accepted";
    EXPECT_THAT(image.error().message, HasSubstr(path.string()));
    return image.error().message;
  }

  testing::TemporaryFolder folder_;
};

TEST_F(ImageFile, APngIsReadBitByBitWhateverItsFilters) {
  const cv::Mat picture = Picture(64, 48);
  for (const int strategy : {cv::IMWRITE_PNG_STRATEGY_DEFAULT, cv::IMWRITE_PNG_STRATEGY_FILTERED,
                             cv::IMWRITE_PNG_STRATEGY_RLE, cv::IMWRITE_PNG_STRATEGY_FIXED}) {
    for (const int level : {0, 1, 9}) {
      const auto path =
          Write("a.png", picture, {cv::IMWRITE_PNG_STRATEGY, strategy, cv::IMWRITE_PNG_COMPRESSION, level});
      const auto image = ReadGrayImage(path, {64, 48});
      ASSERT_TRUE(image) << image.error().message;
      EXPECT_EQ(cv::norm(*image, picture, cv::NORM_INF), 0.0);
    }
  }
}

TEST_F(ImageFile, AColourOrDeepPngIsReadAsGrey) {
  cv::Mat colour(48, 64, CV_8UC3, cv::Scalar(90, 90, 90));
  cv::Mat deep(48, 64, CV_16UC1, cv::Scalar(90 * 257));
  for (const cv::Mat& source : {colour, deep}) {
    const auto image = ReadGrayImage(Write("a.png", source), {64, 48});
    ASSERT_TRUE(image) << image.error().message;
    EXPECT_EQ(image->type(), CV_8UC1);
    EXPECT_NEAR(image->at<std::uint8_t>(10, 10), 90, 1);
  }
}

TEST_F(ImageFile, JpegAndPgmAreReadToo) {
  const cv::Mat picture(48, 64, CV_8UC1, cv::Scalar(77));
  for (const char* name : {"a.jpg", "a.pgm"}) {
    const auto path = Write(name, picture);
    EXPECT_EQ(*ReadImageSize(path), (ImageSize{64, 48})) << name;
    const auto image = ReadGrayImage(path, {64, 48});
    ASSERT_TRUE(image) << image.error().message;
    EXPECT_LE(cv::norm(*image, picture, cv::NORM_INF), 1.0) << name;
  }
}

TEST_F(ImageFile, WhatWeEncodeAsPngIsReadBitByBitByUsAndByOpenCv) {
  const cv::Mat picture = Picture(97, 61);
  for (const cv::Rect& part : {cv::Rect(0, 0, 97, 61), cv::Rect(5, 7, 64, 48), cv::Rect(3, 3, 1, 1)}) {
    const std::vector<std::byte> png = EncodeGrayPng(picture(part));
    const auto ours = DecodeGrayImage(png, {part.width, part.height});
    ASSERT_TRUE(ours) << ours.error().message;
    EXPECT_EQ(cv::norm(*ours, picture(part), cv::NORM_INF), 0.0);
    const std::vector<std::uint8_t> octets(reinterpret_cast<const std::uint8_t*>(png.data()),
                                           reinterpret_cast<const std::uint8_t*>(png.data() + png.size()));
    const cv::Mat theirs = cv::imdecode(octets, cv::IMREAD_UNCHANGED);
    ASSERT_EQ(theirs.type(), CV_8UC1);
    EXPECT_EQ(cv::norm(theirs, picture(part), cv::NORM_INF), 0.0);
  }
}

// What OpenCV makes of a file, nothing where it cannot.
cv::Mat ByOpenCv(const std::string& file) {
  const std::vector<char> octets(file.begin(), file.end());
  return cv::imdecode(octets, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
}

Result<cv::Mat> ByUs(const std::string& file, ImageSize size) {
  return DecodeGrayImage(std::as_bytes(std::span(file)), size);
}

TEST_F(ImageFile, AJpegIsReadBitByBitAsByOpenCv) {
  const cv::Mat gray = Picture(67, 49);
  cv::Mat colours;
  cv::merge(std::vector<cv::Mat>{gray, 255 - gray, Picture(67, 49) / 2}, colours);
  const std::vector<std::vector<int>> kinds = {{},
                                               {cv::IMWRITE_JPEG_QUALITY, 30},
                                               {cv::IMWRITE_JPEG_PROGRESSIVE, 1},
                                               {cv::IMWRITE_JPEG_RST_INTERVAL, 2},
                                               {cv::IMWRITE_JPEG_OPTIMIZE, 1}};
  for (const cv::Mat& source : {gray, colours}) {
    for (const auto& kind : kinds) {
      const std::string file = Bytes(Write("a.jpg", source, kind));
      const auto image = ByUs(file, {67, 49});
      ASSERT_TRUE(image) << image.error().message;
      EXPECT_EQ(cv::norm(*image, ByOpenCv(file), cv::NORM_INF), 0.0);
    }
  }
}

TEST_F(ImageFile, ADamagedJpegIsTakenOrRefusedAsByOpenCv) {
  const std::string whole = Bytes(Write("a.jpg", Picture(64, 48)));
  std::mt19937 random(3);
  int taken = 0;
  int refused = 0;
  ::testing::internal::CaptureStderr();  // OpenCV's warnings
  for (int round = 0; round < 400; ++round) {
    std::string damaged = whole;
    for (int i = 0; i <= round % 4; ++i) damaged[2 + random() % (whole.size() - 4)] = static_cast<char>(random());
    const auto image = ByUs(damaged, {64, 48});
    const cv::Mat theirs = ByOpenCv(damaged);
    (image ? taken : refused) += 1;
    if (image) {
      ASSERT_EQ(theirs.size(), image->size()) << round;
      EXPECT_EQ(cv::norm(*image, theirs, cv::NORM_INF), 0.0) << round;
    } else if (!theirs.empty()) {  // we look at the size first
      EXPECT_THAT(image.error().message, AnyOf(HasSubstr("the calibration says"), HasSubstr("no frame header")))
          << round;
    }
  }
  ::testing::internal::GetCapturedStderr();
  EXPECT_GT(taken, 20);
  EXPECT_GT(refused, 20);
}

TEST_F(ImageFile, ATruncatedPngIsAnErrorWhereverItEnds) {
  const std::string bytes = Bytes(Write("whole.png", Picture(64, 48)));
  const auto path = folder_.path() / "truncated.png";
  for (std::size_t length = 0; length < bytes.size(); length += 1 + length / 16) {
    ASSERT_TRUE(WriteTextFile(path, bytes.substr(0, length)));
    EXPECT_NE(MessageFor(path), "accepted") << length;
  }
  ASSERT_TRUE(WriteTextFile(path, bytes.substr(0, bytes.size() / 2)));
  EXPECT_THAT(MessageFor(path), HasSubstr("truncated"));
  ASSERT_TRUE(WriteTextFile(path, bytes.substr(0, bytes.size() - 1)));
  EXPECT_THAT(MessageFor(path), HasSubstr("truncated"));
}

TEST_F(ImageFile, ATruncatedJpegOrPgmIsAnError) {
  for (const char* name : {"a.jpg", "a.pgm"}) {
    const auto path = Write(name, Picture(64, 48));
    const std::string bytes = Bytes(path);
    for (const std::size_t length : {bytes.size() / 3, bytes.size() / 2, bytes.size() - 1}) {
      ASSERT_TRUE(WriteTextFile(path, bytes.substr(0, length)));
      EXPECT_THAT(MessageFor(path), HasSubstr("truncated")) << name << " " << length;
    }
  }
}

TEST_F(ImageFile, AMissingImageIsAnError) {
  EXPECT_THAT(MessageFor(folder_.path() / "none.png"), HasSubstr("no such file"));
  EXPECT_THAT(MessageFor(folder_.path()), HasSubstr("no such file"));
}

TEST_F(ImageFile, SwappedImageSizesAreAnErrorWithBothSizes) {
  for (const char* name : {"a.png", "a.jpg", "a.pgm"}) {
    const std::string message = MessageFor(Write(name, Picture(48, 64)));
    EXPECT_THAT(message, HasSubstr("48 x 64")) << name;
    EXPECT_THAT(message, HasSubstr("64 x 48")) << name;
  }
}

TEST_F(ImageFile, AFlippedByteOfAPngIsNoticed) {
  const std::string bytes = Bytes(Write("whole.png", Picture(64, 48)));
  const auto path = folder_.path() / "flipped.png";
  for (std::size_t i = 0; i < bytes.size(); i += 7) {
    std::string flipped = bytes;
    flipped[i] = static_cast<char>(flipped[i] ^ 0x55);
    ASSERT_TRUE(WriteTextFile(path, flipped));
    EXPECT_NE(MessageFor(path), "accepted") << i;
  }
}

TEST_F(ImageFile, AnythingElseIsNotAnImage) {
  const auto path = folder_.path() / "a.png";
  for (const std::string text :
       {"", "P5", "P5 64", "P5 64 48 65535\n", "\xFF\xD8", "\xFF\xD8\xFF\xC0", "hello, world"}) {
    ASSERT_TRUE(WriteTextFile(path, text));
    EXPECT_NE(MessageFor(path), "accepted") << text;
  }
}

}  // namespace
}  // namespace pangaea
