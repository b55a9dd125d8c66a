#pragma once

#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace pangaea {

// An 8-bit grey image, not empty, as a PNG file. Made for camera images: noise does not compress, so differences
// between neighbours and the quickest compression of them are all that is worth the time. Any thread.
std::vector<std::byte> EncodeGrayPng(const cv::Mat& gray);

}  // namespace pangaea
