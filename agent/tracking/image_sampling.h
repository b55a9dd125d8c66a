#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace pangaea {

// Pixels of level `level` of an ImagePyramid and of the full image: centres coincide (see patch_pyramid.h).
inline Eigen::Vector2d LevelFromFull(const Eigen::Vector2d& pixel, int level) { return pixel / (1 << level); }
inline Eigen::Vector2d FullFromLevel(const Eigen::Vector2d& pixel, int level) { return pixel * (1 << level); }

// True when bilinear sampling anywhere within `radius` pixels of (u, v) stays inside the image.
inline bool SamplingFits(const cv::Mat& image, double u, double v, double radius) {
  return u >= radius && v >= radius && u < image.cols - 1 - radius && v < image.rows - 1 - radius;
}

// Grey value between pixels; (u, v) must lie inside the image by one pixel.
inline float SampleBilinear(const std::uint8_t* pixels, std::size_t stride, float u, float v) {
  const int column = static_cast<int>(u);
  const int row = static_cast<int>(v);
  const float right = u - static_cast<float>(column);
  const float below = v - static_cast<float>(row);
  const std::uint8_t* p = pixels + static_cast<std::size_t>(row) * stride + static_cast<std::size_t>(column);
  const float upper = static_cast<float>(p[0]) + right * static_cast<float>(p[1] - p[0]);
  const float lower = static_cast<float>(p[stride]) + right * static_cast<float>(p[stride + 1] - p[stride]);
  return upper + below * (lower - upper);
}

// A Size x Size window of grey values, row by row. (u, v) is the position of its first pixel; all pixels share one
// sub-pixel phase, which is what makes this fast.
template <int Size>
inline void SampleWindow(const std::uint8_t* pixels, std::size_t stride, float u, float v, float* window) {
  const int column = static_cast<int>(u);
  const int row = static_cast<int>(v);
  const float right = u - static_cast<float>(column);
  const float below = v - static_cast<float>(row);
  const float w00 = (1.0F - right) * (1.0F - below);
  const float w01 = right * (1.0F - below);
  const float w10 = (1.0F - right) * below;
  const float w11 = right * below;
  const std::uint8_t* p = pixels + static_cast<std::size_t>(row) * stride + static_cast<std::size_t>(column);
  for (int y = 0; y < Size; ++y, p += stride) {
    const std::uint8_t* q = p + stride;
    for (int x = 0; x < Size; ++x) {
      window[y * Size + x] = w00 * static_cast<float>(p[x]) + w01 * static_cast<float>(p[x + 1]) +
                             w10 * static_cast<float>(q[x]) + w11 * static_cast<float>(q[x + 1]);
    }
  }
}

}  // namespace pangaea
