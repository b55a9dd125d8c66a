#pragma once

#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>

#include "common/base/result.h"
#include "common/sensor/image.h"

namespace pangaea {

// A JPEG file (ITU T.81). Error messages here say what is wrong with the bytes; the caller adds the name of the file.
bool IsJpeg(std::span<const std::byte> file);
Result<ImageSize> JpegSize(std::span<const std::byte> file);
// The end-of-image marker is there: the decoder fills what is missing with grey and succeeds.
bool JpegIsComplete(std::span<const std::byte> file);

// The pixels of a JPEG of the size that it declares, by libjpeg as OpenCV calls it, and bit by bit the same: without
// the hundred libraries of OpenCV's other decoders. Nothing for the rare kinds that are left to those: of four
// components (CMYK), or without Huffman tables. Any thread.
std::optional<Result<cv::Mat>> DecodeGrayJpeg(std::span<const std::byte> file, ImageSize size);

}  // namespace pangaea
