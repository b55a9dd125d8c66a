#include "common/sensor/png.h"

#include <libdeflate.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>

namespace pangaea {
namespace {

constexpr std::array<unsigned char, 8> kSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
constexpr std::size_t kChunkFrame = 12;  // length, type and checksum, four bytes each
constexpr std::size_t kHeaderLength = 13;
constexpr std::uint32_t kMaxSide = 1U << 15;  // pixels

std::uint32_t BigEndian(const std::byte* bytes) {
  std::uint32_t value = 0;
  for (int i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint32_t>(bytes[i]);
  return value;
}

bool HasType(const std::byte* type, const char* name) { return std::memcmp(type, name, 4) == 0; }

Status ReadHeader(std::span<const std::byte> header, PngParts& parts) {
  if (header.size() != kHeaderLength) return Fail(ErrorCode::kCorrupt, "the PNG header has a wrong length");
  const std::uint32_t width = BigEndian(header.data());
  const std::uint32_t height = BigEndian(header.data() + 4);
  if (width == 0 || height == 0 || width > kMaxSide || height > kMaxSide) {
    return Fail(ErrorCode::kCorrupt, "the PNG header declares an impossible size");
  }
  parts.size = {static_cast<int>(width), static_cast<int>(height)};
  // Bit depth, colour type, compression, filter method, interlacing.
  const auto at = [&](std::size_t i) { return static_cast<int>(header[i]); };
  parts.is_plain_gray = at(8) == 8 && at(9) == 0 && at(10) == 0 && at(11) == 0 && at(12) == 0;
  return {};
}

// Section 9.4: the predictor of a byte from its left, upper and upper left neighbours.
inline int Paeth(int left, int up, int corner) {
  const int to_left = std::abs(up - corner);
  const int to_up = std::abs(left - corner);
  const int to_corner = std::abs(left + up - 2 * corner);
  const int nearer = to_left <= to_up ? left : up;
  return (to_left <= to_up ? to_left : to_up) <= to_corner ? nearer : corner;
}

// Section 9.2: undoes one line's filter. `above` is a line of zeros for the first one. False for an unknown filter.
bool Unfilter(int filter, const std::uint8_t* in, const std::uint8_t* above, std::uint8_t* out, int width) {
  int left = 0;
  int corner = 0;
  switch (filter) {
    case 0:
      std::memcpy(out, in, static_cast<std::size_t>(width));
      return true;
    case 1:
      for (int x = 0; x < width; ++x) out[x] = static_cast<std::uint8_t>(left = (left + in[x]) & 0xFF);
      return true;
    case 2:
      for (int x = 0; x < width; ++x) out[x] = static_cast<std::uint8_t>(in[x] + above[x]);
      return true;
    case 3:
      for (int x = 0; x < width; ++x) {
        out[x] = static_cast<std::uint8_t>(left = (in[x] + ((left + above[x]) >> 1)) & 0xFF);
      }
      return true;
    case 4:
      for (int x = 0; x < width; ++x) {
        out[x] = static_cast<std::uint8_t>(left = (in[x] + Paeth(left, above[x], corner)) & 0xFF);
        corner = above[x];
      }
      return true;
    default:
      return false;
  }
}

using Decompressor = std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)>;

}  // namespace

bool IsPng(std::span<const std::byte> file) {
  return file.size() >= kSignature.size() && std::memcmp(file.data(), kSignature.data(), kSignature.size()) == 0;
}

Result<PngParts> ParsePng(std::span<const std::byte> file) {
  if (!IsPng(file)) return Fail(ErrorCode::kCorrupt, "not a PNG file");
  PngParts parts;
  parts.compressed.reserve(file.size());
  std::span<const std::byte> rest = file.subspan(kSignature.size());
  for (bool is_first = true;; is_first = false) {
    if (rest.size() < kChunkFrame || BigEndian(rest.data()) > rest.size() - kChunkFrame) {
      return Fail(ErrorCode::kCorrupt, "truncated: the file ends before the PNG does");
    }
    const std::size_t length = BigEndian(rest.data());
    const std::byte* type = rest.data() + 4;
    const std::span<const std::byte> data = rest.subspan(8, length);
    if (libdeflate_crc32(0, type, length + 4) != BigEndian(rest.data() + 8 + length)) {
      return Fail(ErrorCode::kCorrupt, "corrupt: a checksum in the PNG is wrong");
    }
    if (is_first != HasType(type, "IHDR")) return Fail(ErrorCode::kCorrupt, "the PNG does not begin with its header");
    if (is_first) {
      if (auto status = ReadHeader(data, parts); !status) return tl::make_unexpected(status.error());
    }
    if (HasType(type, "IDAT")) parts.compressed.insert(parts.compressed.end(), data.begin(), data.end());
    if (HasType(type, "IEND")) return parts;
    rest = rest.subspan(kChunkFrame + length);
  }
}

Result<cv::Mat> DecodeGrayPng(const PngParts& parts) {
  const auto width = static_cast<std::size_t>(parts.size.width);
  const auto height = static_cast<std::size_t>(parts.size.height);
  const std::size_t stride = width + 1;  // each line begins with the number of its filter
  const auto filtered = std::make_unique_for_overwrite<std::uint8_t[]>(stride * height);
  const Decompressor decompressor(libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
  if (!decompressor) return Fail(ErrorCode::kUnavailable, "no memory to decompress the PNG");
  const libdeflate_result result = libdeflate_zlib_decompress(
      decompressor.get(), parts.compressed.data(), parts.compressed.size(), filtered.get(), stride * height, nullptr);
  if (result != LIBDEFLATE_SUCCESS) return Fail(ErrorCode::kCorrupt, "corrupt: the PNG's pixels do not decompress");
  cv::Mat image(parts.size.height, parts.size.width, CV_8UC1);
  const std::vector<std::uint8_t> zeros(width);
  const std::uint8_t* above = zeros.data();
  for (int row = 0; row < parts.size.height; ++row) {
    const std::uint8_t* line = filtered.get() + static_cast<std::size_t>(row) * stride;
    if (!Unfilter(line[0], line + 1, above, image.ptr(row), parts.size.width)) {
      return Fail(ErrorCode::kCorrupt, "corrupt: the PNG has an unknown filter");
    }
    above = image.ptr(row);
  }
  return image;
}

}  // namespace pangaea
