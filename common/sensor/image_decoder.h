#pragma once

#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <span>
#include <string>

#include "common/base/result.h"

namespace pangaea {

// The module with OpenCV's decoders, and a hundred libraries behind them (common/base/module.h): for images that we do
// not decode ourselves.
struct ImageDecoder {
  static constexpr const char* kFile = "pangaea_image_decoder.so";
  static constexpr const char* kSymbol = "pangaea_image_decoder";
  static constexpr int kVersion = 1;

  int version = kVersion;
  // An image file of any format that OpenCV knows, as 8-bit grey pixels, or why it cannot be decoded. What is missing
  // of a truncated file may be made up. Any thread.
  Result<cv::Mat> (*decode_gray)(std::span<const std::byte> file);
};

// Opened by the first caller, while others wait. `needed_by` says what for, in an error: "a colour PNG". Any thread.
Result<const ImageDecoder*> OpenImageDecoder(const std::string& needed_by);

}  // namespace pangaea
