#include "common/features/scale_pyramid.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/base/check.h"

namespace pangaea {

void ScalePyramid::Build(const cv::Mat& image) {
  PANGAEA_CHECK(image.type() == CV_8UC1 && !image.empty());
  stride_ = image.cols + 2 * kMargin;
  for (std::size_t o = 0; o < octaves_.size(); ++o) {
    const double scale = std::pow(kOctaveScale, static_cast<double>(o));
    const cv::Size size(std::max(2, static_cast<int>(std::lround(image.cols / scale))),
                        std::max(2, static_cast<int>(std::lround(image.rows / scale))));
    ratios_[o] = {static_cast<float>(image.cols) / static_cast<float>(size.width),
                  static_cast<float>(image.rows) / static_cast<float>(size.height)};
    // As wide as the first octave's, whatever is used of it: this gives all octaves one stride.
    buffers_[o].create(size.height + 2 * kMargin, stride_, CV_8UC1);
    cv::Mat& padded = padded_[o];
    padded = buffers_[o](cv::Rect(0, 0, size.width + 2 * kMargin, size.height + 2 * kMargin));
    octaves_[o] = padded(cv::Rect(kMargin, kMargin, size.width, size.height));
    if (o == 0) {
      image.copyTo(octaves_[o]);
    } else {
      cv::resize(octaves_[o - 1], octaves_[o], size, 0.0, 0.0, cv::INTER_LINEAR);
    }
    // Isolated: the margin mirrors the view, not what the last image left in the buffer.
    cv::copyMakeBorder(octaves_[o], padded, kMargin, kMargin, kMargin, kMargin,
                       cv::BORDER_REFLECT_101 | cv::BORDER_ISOLATED);
  }
}

}  // namespace pangaea
