#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

namespace pangaea {

struct PatchAlignment {
  cv::Point2f position;      // in the second image
  double correlation = 0.0;  // zero-mean normalised, of the aligned patches
};

// Moves a 9 x 9 patch over the second image until it looks like the patch around `position` in the first, up to gain
// and offset of brightness (Lucas and Kanade 1981, in the inverse form of Baker and Matthews 2004). Both positions may
// be sub-pixel. None where the patch has no texture along u, leaves an image, drifts more than `max_drift` pixels from
// `start` along u, or does not converge. Row errors are expected to be about `row_sigma` pixels: 0 keeps to start.y.
std::optional<PatchAlignment> AlignPatch(const cv::Mat& first, cv::Point2f position, const cv::Mat& second,
                                         cv::Point2f start, float max_drift, float row_sigma);

}  // namespace pangaea
