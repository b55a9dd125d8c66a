#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

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

}  // namespace pangaea
