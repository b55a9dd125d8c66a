#include "common/lcm/frame_assembler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <opencv2/core.hpp>

#include "common/lcm/image_codec.h"

namespace pangaea {
namespace {

constexpr ImageSize kSize{8, 6};

LcmMessage Images(const std::string& channel, std::vector<std::int64_t> stamps, std::int64_t sequence = -1) {
  std::vector<pangaea_lcm::image_t> images;
  for (const std::int64_t stamp : stamps) {
    const cv::Mat pixels(kSize.height, kSize.width, CV_8UC1, cv::Scalar(10.0 * static_cast<double>(images.size() + 1)));
    images.push_back(ImageMessage(pixels, stamp, sequence));
  }
  return {channel, EncodeImages(images)};
}

LcmChannels TwoChannels() {
  LcmChannels channels;
  channels.images = "LEFT";
  channels.right_images = "RIGHT";
  return channels;
}

double MeanOf(const ImageLoader& image) { return cv::mean(*image())[0]; }

TEST(FrameAssembler, APairIsAFrame) {
  FrameAssembler assembler(SensorKind::kStereo, {}, kSize);
  const auto frame = assembler.Add(Images("PANGAEA_IMAGES", {100, 101}));
  ASSERT_TRUE(frame && *frame);
  EXPECT_EQ((*frame)->stamp_ns, 100);
  EXPECT_EQ(MeanOf((*frame)->left), 10.0);
  EXPECT_EQ(MeanOf((*frame)->right), 20.0);
}

TEST(FrameAssembler, AMonocularSensorTakesSingleImagesAndTheLeftOnesOfPairs) {
  FrameAssembler assembler(SensorKind::kMonocular, {}, kSize);
  for (const auto& message : {Images("PANGAEA_IMAGES", {100}), Images("PANGAEA_IMAGES", {100, 100})}) {
    const auto frame = assembler.Add(message);
    ASSERT_TRUE(frame && *frame);
    EXPECT_FALSE((*frame)->right);
  }
}

TEST(FrameAssembler, ImagesOfTwoChannelsArePairedByStampInAnyOrder) {
  FrameAssembler assembler(SensorKind::kStereo, TwoChannels(), kSize);
  constexpr std::int64_t kFrame_ns = 50'000'000;
  EXPECT_FALSE(assembler.Add(Images("LEFT", {kFrame_ns})));
  EXPECT_FALSE(assembler.Add(Images("LEFT", {2 * kFrame_ns})));
  const auto first = assembler.Add(Images("RIGHT", {kFrame_ns + 1'000'000}));
  ASSERT_TRUE(first && *first);
  EXPECT_EQ((*first)->stamp_ns, kFrame_ns) << "the left image's stamp counts";
  EXPECT_FALSE(assembler.Add(Images("RIGHT", {3 * kFrame_ns})));
  const auto second = assembler.Add(Images("RIGHT", {2 * kFrame_ns}));
  ASSERT_TRUE(second && *second);
  const auto third = assembler.Add(Images("LEFT", {3 * kFrame_ns}));
  ASSERT_TRUE(third && *third);
  EXPECT_EQ(assembler.missing(), 0U);
}

TEST(FrameAssembler, HalvesThatFindNoOtherHalfAreForgottenAndCounted) {
  FrameAssembler assembler(SensorKind::kStereo, TwoChannels(), kSize);
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(assembler.Add(Images("LEFT", {i * 50'000'000LL})));
  EXPECT_EQ(assembler.missing(), 92U) << "eight may still find theirs";
}

TEST(FrameAssembler, GapsInTheSequenceAreCounted) {
  FrameAssembler assembler(SensorKind::kStereo, {}, kSize);
  for (const std::int64_t sequence : {7, 8, 11, 11, 12, 0, 1, -1, 3}) {
    assembler.Add(Images("PANGAEA_IMAGES", {1, 1}, sequence));
  }
  EXPECT_EQ(assembler.missing(), 3U) << "9 and 10, and 2 after the camera counted anew";
}

TEST(FrameAssembler, WhatIsNoImageIsAnErrorThatNamesTheChannel) {
  FrameAssembler assembler(SensorKind::kStereo, {}, kSize);
  LcmMessage message = Images("PANGAEA_IMAGES", {1, 1});
  message.payload.resize(50);
  const auto truncated = assembler.Add(message);
  ASSERT_TRUE(truncated);
  EXPECT_THAT(truncated->error().message, ::testing::HasSubstr("PANGAEA_IMAGES: an image message of 50 octets"));
  const auto single = assembler.Add(Images("PANGAEA_IMAGES", {1}));
  ASSERT_TRUE(single);
  EXPECT_THAT(single->error().message, ::testing::HasSubstr("carries single images; allowed: pairs"));
}

TEST(FrameAssembler, AnyStampAndSequenceIsSurvived) {
  FrameAssembler assembler(SensorKind::kStereo, TwoChannels(), kSize);
  for (const std::int64_t number : {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max(),
                                    std::int64_t{0}, std::int64_t{-1}}) {
    assembler.Add(Images("LEFT", {number}, number));
    const auto frame = assembler.Add(Images("RIGHT", {number}, number));
    EXPECT_TRUE(frame && *frame) << number;
  }
}

}  // namespace
}  // namespace pangaea
