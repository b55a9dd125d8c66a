#pragma once

#include <cstdint>
#include <opencv2/core/types.hpp>

namespace pangaea {

// Sub-pixel offset, within half a pixel, of the corner at `center`: the top of a quadric through the 3 x 3 corner
// responses around it (after Harris and Stephens 1988, with the response det / trace of Noble 1988). Reads 5 pixels
// around `center`; `stride` is in bytes.
cv::Point2f RefineCorner(const std::uint8_t* center, int stride);

}  // namespace pangaea
