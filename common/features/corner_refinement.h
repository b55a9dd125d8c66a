#pragma once

#include <cstdint>
#include <opencv2/core/types.hpp>

namespace pangaea {

// How far RefineCorner moves a corner at most, along each axis, pixels. FAST answers inside of a corner, up to two
// pixels from its tip.
inline constexpr float kLargestRefinement = 2.0F;
// Pixels around `center` that RefineCorner reads.
inline constexpr int kRefinementReach = 7;

// Offset from `center` to the point nearest to all edges of the patch around it (Foerstner and Guelch 1987); (0, 0)
// where that is ill-defined or too far away. `stride` is in bytes.
cv::Point2f RefineCorner(const std::uint8_t* center, int stride);

}  // namespace pangaea
