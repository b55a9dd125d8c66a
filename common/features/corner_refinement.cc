#include "common/features/corner_refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace pangaea {
namespace {

constexpr int kWindow = 7;              // pixels summed in each direction
constexpr int kSide = kWindow + 2;      // gradients needed for 3 x 3 windows
constexpr float kLargestOffset = 0.5F;  // beyond it, the neighbouring pixel would have been the maximum

// Sums of products of the gradient over the 3 x 3 windows.
struct StructureTensors {
  std::array<std::array<std::int32_t, 3>, 3> xx{}, xy{}, yy{};
};

StructureTensors SumTensors(const std::uint8_t* center, int stride) {
  StructureTensors sums;
  for (int y = 0; y < kSide; ++y) {
    const std::uint8_t* row = center + static_cast<std::ptrdiff_t>(y - kSide / 2) * stride - kSide / 2;
    std::array<std::int32_t, kSide> xx, xy, yy;
    for (int x = 0; x < kSide; ++x) {
      const std::int32_t gx = row[x + 1] - row[x - 1];
      const std::int32_t gy = row[x + stride] - row[x - stride];
      const auto i = static_cast<std::size_t>(x);
      xx[i] = gx * gx, xy[i] = gx * gy, yy[i] = gy * gy;
    }
    for (std::size_t column = 0; column < 3; ++column) {
      std::int32_t row_xx = 0, row_xy = 0, row_yy = 0;
      for (std::size_t x = column; x < column + kWindow; ++x) row_xx += xx[x], row_xy += xy[x], row_yy += yy[x];
      for (int window = std::max(0, y - kWindow + 1); window <= std::min(2, y); ++window) {
        const auto r = static_cast<std::size_t>(window);
        sums.xx[r][column] += row_xx, sums.xy[r][column] += row_xy, sums.yy[r][column] += row_yy;
      }
    }
  }
  return sums;
}

float Response(std::int32_t xx, std::int32_t xy, std::int32_t yy) {
  const auto a = static_cast<float>(xx), b = static_cast<float>(xy), c = static_cast<float>(yy);
  return (a * c - b * b) / (a + c + 1.0F);  // + 1: a flat patch has response 0
}

}  // namespace

cv::Point2f RefineCorner(const std::uint8_t* center, int stride) {
  const StructureTensors sums = SumTensors(center, stride);
  std::array<std::array<float, 3>, 3> r;
  for (std::size_t i = 0; i < 9; ++i) {
    r[i / 3][i % 3] = Response(sums.xx[i / 3][i % 3], sums.xy[i / 3][i % 3], sums.yy[i / 3][i % 3]);
  }
  // Least-squares quadric through the nine responses.
  const float dx = (r[0][2] + r[1][2] + r[2][2] - r[0][0] - r[1][0] - r[2][0]) / 6.0F;
  const float dy = (r[2][0] + r[2][1] + r[2][2] - r[0][0] - r[0][1] - r[0][2]) / 6.0F;
  float dxx = -2.0F * (r[0][1] + r[1][1] + r[2][1]), dyy = -2.0F * (r[1][0] + r[1][1] + r[1][2]);
  for (std::size_t i = 0; i < 3; ++i) dxx += r[i][0] + r[i][2], dyy += r[0][i] + r[2][i];
  dxx /= 3.0F, dyy /= 3.0F;
  const float dxy = (r[0][0] + r[2][2] - r[0][2] - r[2][0]) / 4.0F;
  const float determinant = dxx * dyy - dxy * dxy;
  if (!(dxx < 0.0F) || !(determinant > 0.0F)) return {0.0F, 0.0F};  // not a maximum
  const float x = (dxy * dy - dyy * dx) / determinant;
  const float y = (dxy * dx - dxx * dy) / determinant;
  return {std::clamp(x, -kLargestOffset, kLargestOffset), std::clamp(y, -kLargestOffset, kLargestOffset)};
}

}  // namespace pangaea
