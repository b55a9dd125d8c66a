#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <pangaea_lcm/image_t.hpp>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/sensor/image.h"

namespace pangaea {

// The images of a message: one (image_t), or two, the left one first (image_pair_t). Any octets may come: what is
// truncated, has octets left over or is of another type is an error. Says nothing about what the images hold.
Result<std::vector<pangaea_lcm::image_t>> DecodeImages(std::span<const std::byte> payload);

// One image_t, or an image_pair_t of two.
std::vector<std::byte> EncodeImages(const std::vector<pangaea_lcm::image_t>& images);

// The message of an 8-bit grey image.
pangaea_lcm::image_t ImageMessage(const cv::Mat& gray, std::int64_t stamp_ns, std::int64_t sequence);

// The pixels as an 8-bit grey image of its own. An unknown pixel format, a size that is not the expected one, rows that
// do not fit the data, or a file that cannot be decoded are errors.
Result<cv::Mat> GrayImageOf(const pangaea_lcm::image_t& message, ImageSize expected);

}  // namespace pangaea
