#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace pangaea {

// A smooth, non-repeating texture with corners everywhere; structures are about `grain` pixels large.
inline cv::Mat TexturedImage(int width, int height, std::uint64_t seed, int grain = 6) {
  cv::RNG random(seed);
  cv::Mat image(height, width, CV_8UC1, cv::Scalar(0));
  cv::Mat sum(height, width, CV_32FC1, cv::Scalar(0));
  for (const int size : {grain, 3 * grain, 8 * grain}) {
    cv::Mat coarse(height / size + 3, width / size + 3, CV_32FC1), fine;
    random.fill(coarse, cv::RNG::UNIFORM, 0.0, 85.0);
    cv::resize(coarse, fine, {}, size, size, cv::INTER_CUBIC);
    sum += fine(cv::Rect(0, 0, width, height));
  }
  sum.convertTo(image, CV_8UC1);
  return image;
}

}  // namespace pangaea
