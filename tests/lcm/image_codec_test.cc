#include "common/lcm/image_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <random>

namespace pangaea {
namespace {

using pangaea_lcm::image_t;
using ::testing::HasSubstr;

constexpr ImageSize kSize{13, 7};  // no multiple of anything

cv::Mat RandomGray(int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  cv::Mat image(kSize.height, kSize.width, CV_8UC1);
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) image.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(random());
  }
  return image;
}

bool Equal(const cv::Mat& a, const cv::Mat& b) { return a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0.0; }

std::vector<std::byte> PairOfTwo() {
  return EncodeImages({ImageMessage(RandomGray(1), 100, 5), ImageMessage(RandomGray(2), 100, 5)});
}

std::string MessageOf(const image_t& image) {
  const auto gray = GrayImageOf(image, kSize);
  return gray ? "accepted" : gray.error().message;
}

TEST(LcmImageCodec, WhatWasEncodedIsDecoded) {
  const auto images = DecodeImages(PairOfTwo());
  ASSERT_TRUE(images) << images.error().message;
  ASSERT_EQ(images->size(), 2U);
  for (int i = 0; i < 2; ++i) {
    const image_t& image = (*images)[static_cast<std::size_t>(i)];
    EXPECT_EQ(image.stamp_ns, 100);
    EXPECT_EQ(image.sequence, 5);
    EXPECT_TRUE(Equal(*GrayImageOf(image, kSize), RandomGray(i + 1)));
  }
  const auto single = DecodeImages(EncodeImages({ImageMessage(RandomGray(3), -7, -1)}));
  ASSERT_TRUE(single);
  EXPECT_EQ(single->size(), 1U);
  EXPECT_EQ(single->front().stamp_ns, -7);
}

TEST(LcmImageCodec, PartOfAnImageIsCopiedRowByRow) {
  const cv::Mat whole = RandomGray(4);
  const cv::Mat part = whole(cv::Rect(2, 1, 5, 4));
  EXPECT_TRUE(Equal(*GrayImageOf(ImageMessage(part, 0, 0), {5, 4}), part));
}

TEST(LcmImageCodec, EveryTruncationIsAnError) {
  for (const auto& whole : {PairOfTwo(), EncodeImages({ImageMessage(RandomGray(1), 0, 0)})}) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      EXPECT_FALSE(DecodeImages(std::span(whole).first(size))) << size;
    }
    auto longer = whole;
    longer.push_back(std::byte{0});
    EXPECT_FALSE(DecodeImages(longer)) << "an octet is left over";
  }
}

TEST(LcmImageCodec, NoClaimOfASizeIsBelieved) {
  // Where the size of the left image's data stands: after the fingerprint and six members.
  constexpr std::size_t kSizePlace = 40;
  for (const std::uint32_t claim : {0U, 90U, 92U, 1000U, 0x7FFFFFFFU, 0x80000000U, 0xFFFFFFFFU}) {
    auto payload = PairOfTwo();
    for (std::size_t i = 0; i < 4; ++i) payload[kSizePlace + i] = static_cast<std::byte>(claim >> (24U - 8U * i));
    EXPECT_FALSE(DecodeImages(payload)) << claim;
  }
}

TEST(LcmImageCodec, DamagedOctetsNeverDoHarm) {
  std::mt19937 random(7);
  for (int round = 0; round < 3000; ++round) {
    auto payload = PairOfTwo();
    for (int i = 0; i < 1 + round % 8; ++i) payload[random() % payload.size()] = static_cast<std::byte>(random());
    const auto images = DecodeImages(payload);
    if (!images) continue;
    for (const image_t& image : *images) {
      const auto gray = GrayImageOf(image, kSize);
      EXPECT_TRUE(!gray || gray->total() == 91U);
    }
  }
}

TEST(LcmImageCodec, AMessageOfAnotherTypeIsAnError) {
  std::vector<std::byte> payload(200, std::byte{0x5A});
  EXPECT_THAT(DecodeImages(payload).error().message, HasSubstr("another type or version"));
}

TEST(LcmImageCodec, ColoursBecomeGrey) {
  const std::uint8_t rgb[3] = {200, 100, 50};
  image_t image{};
  image.width = kSize.width;
  image.height = kSize.height;
  image.row_stride = 3 * kSize.width + 2;  // padded
  image.pixel_format = image_t::RGB8;
  image.data.resize(static_cast<std::size_t>(image.row_stride) * kSize.height);
  for (int v = 0; v < kSize.height; ++v) {
    for (int u = 0; u < kSize.width; ++u) {
      std::memcpy(image.data.data() + static_cast<std::ptrdiff_t>(v) * image.row_stride + 3 * u, rgb, 3);
    }
  }
  image.size = static_cast<std::int32_t>(image.data.size());
  // ITU-R BT.601: 0.299 R + 0.587 G + 0.114 B.
  const auto from_rgb = GrayImageOf(image, kSize);
  ASSERT_TRUE(from_rgb) << from_rgb.error().message;
  EXPECT_NEAR(cv::mean(*from_rgb)[0], 124.0, 0.1);
  image.pixel_format = image_t::BGR8;
  EXPECT_NEAR(cv::mean(*GrayImageOf(image, kSize))[0], 96.0, 0.1);
}

TEST(LcmImageCodec, AWholeImageFileIsDecoded) {
  std::vector<std::uint8_t> file;
  ASSERT_TRUE(cv::imencode(".png", RandomGray(9), file));
  image_t image{};
  image.width = kSize.width;
  image.height = kSize.height;
  image.pixel_format = image_t::IMAGE_FILE;
  image.data = file;
  image.size = static_cast<std::int32_t>(file.size());
  EXPECT_TRUE(Equal(*GrayImageOf(image, kSize), RandomGray(9)));
  image.data.resize(file.size() / 2);
  image.size = static_cast<std::int32_t>(image.data.size());
  EXPECT_THAT(MessageOf(image), HasSubstr("truncated"));
}

TEST(LcmImageCodec, ImagesThatDoNotFitAreRefusedAndSayWhy) {
  const image_t good = ImageMessage(RandomGray(1), 0, 0);
  EXPECT_EQ(MessageOf(good), "accepted");
  image_t image = good;
  image.pixel_format = 77;
  EXPECT_THAT(MessageOf(image), HasSubstr("pixel format 77; allowed: 1 (GRAY8)"));
  image = good;
  std::swap(image.width, image.height);
  EXPECT_THAT(MessageOf(image), HasSubstr("7 x 13 pixels, the calibration says 13 x 7"));
  image = good;
  image.row_stride = 12;
  EXPECT_THAT(MessageOf(image), HasSubstr("12 octets a row"));
  image = good;
  image.row_stride = 0x7FFFFFFF;
  EXPECT_THAT(MessageOf(image), HasSubstr("octets a row"));
  image = good;
  image.row_stride = -13;
  EXPECT_THAT(MessageOf(image), HasSubstr("octets a row"));
  image = good;
  image.data.pop_back();
  --image.size;
  EXPECT_THAT(MessageOf(image), HasSubstr("90 octets for 13 x 7 pixels"));
}

}  // namespace
}  // namespace pangaea
