#include "common/sensor/image.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/sensor/image_decoder.h"
#include "common/sensor/jpeg.h"
#include "common/sensor/png.h"

namespace pangaea {
namespace {

using Bytes = std::vector<std::byte>;

constexpr std::uintmax_t kMaxFileBytes = 256U << 20U;

Result<Bytes> ReadBytes(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return Fail(ErrorCode::kNotFound, "there is no such file");
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error || size > kMaxFileBytes) return Fail(ErrorCode::kCorrupt, "too large for an image");
  if (size == 0) return Fail(ErrorCode::kCorrupt, "truncated: the file is empty");
  Bytes bytes(size);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!file) return Fail(ErrorCode::kUnavailable, "the file cannot be read");
  return bytes;
}

int ByteAt(std::span<const std::byte> bytes, std::size_t i) { return static_cast<int>(bytes[i]); }

// A binary PGM: "P5", width, height, largest value, one blank, pixels.
struct PgmParts {
  ImageSize size;
  std::span<const std::byte> pixels;
};

Result<PgmParts> ParsePgm(std::span<const std::byte> file) {
  std::size_t at = 2;
  int numbers[3] = {};
  for (int& number : numbers) {
    while (at < file.size() && (std::isspace(ByteAt(file, at)) != 0 || ByteAt(file, at) == '#')) {
      const bool is_comment = ByteAt(file, at) == '#';
      while (is_comment && at + 1 < file.size() && ByteAt(file, at) != '\n') ++at;
      ++at;
    }
    while (at < file.size() && std::isdigit(ByteAt(file, at)) != 0 && number < 1 << 20) {
      number = number * 10 + (ByteAt(file, at++) - '0');
    }
  }
  ++at;
  if (numbers[0] <= 0 || numbers[1] <= 0 || numbers[2] <= 0 || numbers[2] > 255 || at > file.size()) {
    return Fail(ErrorCode::kCorrupt, "the PGM header is not that of an 8-bit image");
  }
  return PgmParts{{numbers[0], numbers[1]}, file.subspan(at)};
}

bool IsPgm(std::span<const std::byte> file) {
  return file.size() >= 2 && ByteAt(file, 0) == 'P' && ByteAt(file, 1) == '5';
}

Status CheckSize(ImageSize size, ImageSize expected) {
  if (size == expected) return {};
  const auto text = [](ImageSize s) { return std::to_string(s.width) + " x " + std::to_string(s.height); };
  return Fail(ErrorCode::kCorrupt, "the image is " + text(size) + " pixels, the calibration says " + text(expected));
}

// `kind` is what the file holds, in words.
Result<cv::Mat> DecodeWithOpenCv(std::span<const std::byte> file, ImageSize expected, const std::string& kind) {
  const auto decoder = OpenImageDecoder(kind);
  if (!decoder) return tl::make_unexpected(decoder.error());
  auto image = (*decoder)->decode_gray(file);
  if (!image) return image;
  if (auto status = CheckSize({image->cols, image->rows}, expected); !status) {
    return tl::make_unexpected(status.error());
  }
  return image;
}

Result<cv::Mat> DecodePng(std::span<const std::byte> file, ImageSize expected) {
  const auto parts = ParsePng(file);
  if (!parts) return tl::make_unexpected(parts.error());
  if (auto status = CheckSize(parts->size, expected); !status) return tl::make_unexpected(status.error());
  if (parts->is_plain_gray) return DecodeGrayPng(*parts);
  return DecodeWithOpenCv(file, expected, "a PNG that is not of 8-bit grey pixels");
}

Result<cv::Mat> DecodeJpeg(std::span<const std::byte> file, ImageSize expected) {
  const auto size = JpegSize(file);
  if (!size) return tl::make_unexpected(size.error());
  if (auto status = CheckSize(*size, expected); !status) return tl::make_unexpected(status.error());
  if (!JpegIsComplete(file)) return Fail(ErrorCode::kCorrupt, "truncated: the file ends before the JPEG does");
  if (auto image = DecodeGrayJpeg(file, *size)) return std::move(*image);
  return DecodeWithOpenCv(file, expected, "a JPEG of four components or without Huffman tables");
}

Result<cv::Mat> DecodePgm(std::span<const std::byte> file, ImageSize expected) {
  const auto parts = ParsePgm(file);
  if (!parts) return tl::make_unexpected(parts.error());
  if (auto status = CheckSize(parts->size, expected); !status) return tl::make_unexpected(status.error());
  cv::Mat image(expected.height, expected.width, CV_8UC1);
  if (parts->pixels.size() < image.total()) {
    return Fail(ErrorCode::kCorrupt, "truncated: the file ends before the PGM's pixels do");
  }
  std::memcpy(image.data, parts->pixels.data(), image.total());
  return image;
}

Result<ImageSize> SizeOf(std::span<const std::byte> file) {
  if (IsPng(file)) return ParsePng(file).map([](const PngParts& parts) { return parts.size; });
  if (IsJpeg(file)) return JpegSize(file);
  if (IsPgm(file)) return ParsePgm(file).map([](const PgmParts& parts) { return parts.size; });
  return Fail(ErrorCode::kUnsupported, "neither a PNG nor a JPEG nor a binary PGM file");
}

template <typename T>
Result<T> NameFile(Result<T> result, const std::filesystem::path& path) {
  if (!result) result.error().message = path.string() + ": " + result.error().message;
  return result;
}

}  // namespace

Result<std::vector<std::byte>> ReadImageFile(const std::filesystem::path& path) {
  return NameFile(ReadBytes(path), path);
}

Result<ImageSize> ReadImageSize(const std::filesystem::path& path) {
  const auto file = ReadBytes(path);
  if (!file) return NameFile<ImageSize>(tl::make_unexpected(file.error()), path);
  return NameFile(SizeOf(*file), path);
}

Result<cv::Mat> DecodeGrayImage(std::span<const std::byte> file, ImageSize expected) {
  if (IsPng(file)) return DecodePng(file, expected);
  if (IsJpeg(file)) return DecodeJpeg(file, expected);
  if (IsPgm(file)) return DecodePgm(file, expected);
  return Fail(ErrorCode::kUnsupported, "neither a PNG nor a JPEG nor a binary PGM file");
}

Result<cv::Mat> ReadGrayImage(const std::filesystem::path& path, ImageSize expected) {
  const auto file = ReadBytes(path);
  if (!file) return NameFile<cv::Mat>(tl::make_unexpected(file.error()), path);
  return NameFile(DecodeGrayImage(*file, expected), path);
}

}  // namespace pangaea
