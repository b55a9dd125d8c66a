#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace pangaea {

// An image and its halvings, for patch tracking. A pixel (u, v) of level 0 is (u, v) / 2^l at level l: pixel centres
// coincide, there is no half-pixel offset.
struct ImagePyramid {
  std::vector<cv::Mat> levels;  // CV_8UC1; level l is half as wide and high as l - 1, rounded up
};

inline constexpr int kMaxPyramidLevels = 5;

// Level 0 refers to `image`'s own pixels (no copy: they must not change while the pyramid is used); further levels are
// smoothed with the 5-tap binomial filter (Burt and Adelson 1983) and reuse the buffers `pyramid` has. `levels` is 1
// to kMaxPyramidLevels. One pyramid belongs to one thread.
void BuildImagePyramid(const cv::Mat& image, int levels, ImagePyramid& pyramid);

// A pyramid that keeps its pixels when the original's buffers are used again. Level 0 is shared: it never changes.
ImagePyramid CopyPyramid(const ImagePyramid& pyramid);

}  // namespace pangaea
