#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

namespace pangaea {

struct RowAlignment {
  cv::Point2f position;      // in the right image
  double correlation = 0.0;  // zero-mean normalised, of the aligned patches
};

struct RowAlignmentOptions {
  float max_drift = 1.5F;    // from the start, pixels, along either axis
  float row_sigma = 0.3F;    // pixels by which rows are expected to be off (rectification error)
  float slant_sigma = 0.2F;  // expected change of disparity per pixel, along u and along v: slanted surfaces
};

// Aligns a 9 x 9 patch of the left image to the right image: Lucas and Kanade 1981, with the gradients of the left
// patch as in the inverse form of Baker and Matthews 2004. Unknown are the shift along the row, with the priors above
// the shift across it and the slant of the surface (without it, half of the error on a floor is the slant's), and gain
// and offset of brightness. Positions are sub-pixel. None where the patch has no texture along u, leaves an image,
// drifts too far from `start` or does not converge.
std::optional<RowAlignment> AlignAlongRow(const cv::Mat& left, cv::Point2f position, const cv::Mat& right,
                                          cv::Point2f start, const RowAlignmentOptions& options = {});

}  // namespace pangaea
