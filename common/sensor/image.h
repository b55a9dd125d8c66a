#pragma once

#include <cstddef>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "common/base/result.h"

namespace pangaea {

struct ImageSize {
  int width = 0;   // pixels
  int height = 0;  // pixels
  bool operator==(const ImageSize&) const = default;
};

// The size that the header of a PNG, JPEG or binary PGM file declares.
Result<ImageSize> ReadImageSize(const std::filesystem::path& path);

// A PNG, JPEG or binary PGM file as an 8-bit grey image. A file that is missing, truncated, corrupt or of another size
// is an error that names it and what is wrong: never an exception, never half an image. Any thread.
Result<cv::Mat> ReadGrayImage(const std::filesystem::path& path, ImageSize expected);

// The octets of a file that is to hold an image, unjudged.
Result<std::vector<std::byte>> ReadImageFile(const std::filesystem::path& path);
// As ReadGrayImage, from the octets of a file; the message names none.
Result<cv::Mat> DecodeGrayImage(std::span<const std::byte> file, ImageSize expected);

}  // namespace pangaea
