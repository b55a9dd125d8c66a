#pragma once

#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/sensor/image.h"

namespace pangaea {

// A PNG file taken apart (W3C, "Portable Network Graphics (PNG) Specification", second edition). Error messages here
// say what is wrong with the bytes; the caller adds the name of the file.
struct PngParts {
  ImageSize size;
  // 8-bit grey without interlacing: what DecodeGrayPng can do.
  bool is_plain_gray = false;
  std::vector<std::byte> compressed;  // the zlib stream of all IDAT chunks
};

bool IsPng(std::span<const std::byte> file);
// Checks the chunks and their checksums up to and including the closing one.
Result<PngParts> ParsePng(std::span<const std::byte> file);
// The pixels of a plain grey PNG, about twice as fast as the general decoder: cameras' frames are all of this kind.
Result<cv::Mat> DecodeGrayPng(const PngParts& parts);

}  // namespace pangaea
