#include "common/lcm/image_codec.h"

#include <cstring>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <pangaea_lcm/image_pair_t.hpp>
#include <string>
#include <utility>

#include "common/lcm/message_codec.h"

namespace pangaea {
namespace {

using pangaea_lcm::image_pair_t;
using pangaea_lcm::image_t;

// Octets of image_t before `size`, and of `size` itself: what idl/lcm/image_t.lcm says, without the type's fingerprint.
constexpr std::size_t kBeforeSize = 32;
constexpr std::size_t kSizeOctets = 4;
constexpr std::size_t kFingerprintOctets = 8;

std::uint64_t BigEndian(std::span<const std::byte> octets) {
  std::uint64_t number = 0;
  for (const std::byte octet : octets) number = number << 8U | std::to_integer<std::uint64_t>(octet);
  return number;
}

// lcm-gen's code makes room for as many pixels as a message claims. So the claims are checked first.
bool ClaimsFit(std::span<const std::byte> rest, int images) {
  for (int i = 0; i < images; ++i) {
    if (rest.size() < kBeforeSize + kSizeOctets) return false;
    const std::uint64_t claimed = BigEndian(rest.subspan(kBeforeSize, kSizeOctets));
    rest = rest.subspan(kBeforeSize + kSizeOctets);
    if (claimed > rest.size()) return false;
    rest = rest.subspan(claimed);
  }
  return rest.empty();
}

Error WrongImages(const std::string& why, std::size_t size) {
  return {ErrorCode::kCorrupt, "an image message of " + std::to_string(size) + " octets " + why};
}

std::optional<int> ChannelsOf(std::int32_t pixel_format) {
  if (pixel_format == image_t::GRAY8) return 1;
  if (pixel_format == image_t::RGB8 || pixel_format == image_t::BGR8) return 3;
  return std::nullopt;
}

std::string SizeText(std::int64_t width, std::int64_t height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

Result<cv::Mat> GrayFromRows(const image_t& message, int channels) {
  const std::int64_t row = std::int64_t{message.width} * channels;
  const std::int64_t needed = std::int64_t{message.row_stride} * (message.height - 1) + row;
  if (message.row_stride < row || needed > message.size) {
    return Fail(ErrorCode::kCorrupt, "an image message has " + std::to_string(message.size) + " octets for " +
                                         SizeText(message.width, message.height) + " pixels, " +
                                         std::to_string(message.row_stride) + " octets a row");
  }
  const cv::Mat pixels(message.height, message.width, CV_8UC(channels),
                       const_cast<std::uint8_t*>(message.data.data()),  // only read
                       static_cast<std::size_t>(message.row_stride));
  if (channels == 1) return pixels.clone();
  cv::Mat gray;
  cv::cvtColor(pixels, gray, message.pixel_format == image_t::RGB8 ? cv::COLOR_RGB2GRAY : cv::COLOR_BGR2GRAY);
  return gray;
}

}  // namespace

Result<std::vector<image_t>> DecodeImages(std::span<const std::byte> payload) {
  const std::size_t size = payload.size();
  if (size < kFingerprintOctets) return tl::make_unexpected(WrongImages("is truncated", size));
  const auto fingerprint = static_cast<std::int64_t>(BigEndian(payload.first(kFingerprintOctets)));
  const bool is_pair = fingerprint == image_pair_t::getHash();
  if (!is_pair && fingerprint != image_t::getHash()) {
    return tl::make_unexpected(WrongImages("is of another type or version", size));
  }
  if (!ClaimsFit(payload.subspan(kFingerprintOctets), is_pair ? 2 : 1)) {
    return tl::make_unexpected(WrongImages("is truncated, or claims a wrong size", size));
  }
  std::vector<image_t> images;
  if (is_pair) {
    auto pair = DecodeMessage<image_pair_t>(payload);
    if (!pair) return tl::make_unexpected(pair.error());
    images.push_back(std::move(pair->left));
    images.push_back(std::move(pair->right));
  } else {
    auto image = DecodeMessage<image_t>(payload);
    if (!image) return tl::make_unexpected(image.error());
    images.push_back(std::move(*image));
  }
  return images;
}

std::vector<std::byte> EncodeImages(const std::vector<image_t>& images) {
  if (images.size() == 1) return EncodeMessage(images.front());
  return EncodeMessage(image_pair_t{.left = images.front(), .right = images.back()});
}

image_t ImageMessage(const cv::Mat& gray, std::int64_t stamp_ns, std::int64_t sequence) {
  image_t message{};
  message.stamp_ns = stamp_ns;
  message.sequence = sequence;
  message.width = gray.cols;
  message.height = gray.rows;
  message.row_stride = gray.cols;
  message.pixel_format = image_t::GRAY8;
  message.data.resize(gray.total());
  for (int row = 0; row < gray.rows; ++row) {
    std::memcpy(message.data.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(gray.cols),
                gray.ptr(row), static_cast<std::size_t>(gray.cols));
  }
  message.size = static_cast<std::int32_t>(message.data.size());
  return message;
}

Result<cv::Mat> GrayImageOf(const image_t& message, ImageSize expected) {
  if (message.width != expected.width || message.height != expected.height) {
    return Fail(ErrorCode::kCorrupt, "an image message is of " + SizeText(message.width, message.height) +
                                         " pixels, the calibration says " + SizeText(expected.width, expected.height));
  }
  if (message.pixel_format == image_t::IMAGE_FILE) {
    return DecodeGrayImage(std::as_bytes(std::span(message.data)), expected);
  }
  if (const auto channels = ChannelsOf(message.pixel_format)) return GrayFromRows(message, *channels);
  return Fail(ErrorCode::kUnsupported, "an image message has the pixel format " + std::to_string(message.pixel_format) +
                                           "; allowed: 1 (GRAY8), 2 (RGB8), 3 (BGR8), 4 (IMAGE_FILE)");
}

}  // namespace pangaea
