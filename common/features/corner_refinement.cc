#include "common/features/corner_refinement.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace pangaea {
namespace {

constexpr int kRadius = 4;
constexpr int kSide = 2 * kRadius + 1;
// Weights fall off as a Gaussian of this sigma, pixels: measured best among 1.5 to 2.5 for repeatability.
constexpr float kSigma = 2.5F;
// Below this share of the squared trace, the determinant of the structure tensor says "an edge, not a corner".
constexpr float kLeastDeterminant = 1e-3F;

using Weights = std::array<std::array<float, kSide>, kSide>;
const Weights kWeights = [] {
  Weights weights;
  for (std::size_t i = 0; i < kSide * kSide; ++i) {
    const float x = static_cast<float>(i % kSide) - kRadius, y = static_cast<float>(i / kSide) - kRadius;
    weights[i / kSide][i % kSide] = std::exp(-(x * x + y * y) / (2.0F * kSigma * kSigma));
  }
  return weights;
}();

// Solves sum(w g g^T) (p - x) = 0 for the corner p, with gradients g at the pixels x.
std::optional<cv::Point2f> SolveCorner(const std::uint8_t* center, int stride) {
  float xx = 0.0F, xy = 0.0F, yy = 0.0F, right_x = 0.0F, right_y = 0.0F;
  for (int y = -kRadius; y <= kRadius; ++y) {
    const std::uint8_t* row = center + static_cast<std::ptrdiff_t>(y) * stride;
    for (int x = -kRadius; x <= kRadius; ++x) {
      const float weight = kWeights[static_cast<std::size_t>(y + kRadius)][static_cast<std::size_t>(x + kRadius)];
      const auto gx = static_cast<float>(row[x + 1] - row[x - 1]);
      const auto gy = static_cast<float>(row[x + stride] - row[x - stride]);
      const float wxx = weight * gx * gx, wxy = weight * gx * gy, wyy = weight * gy * gy;
      xx += wxx, xy += wxy, yy += wyy;
      right_x += wxx * static_cast<float>(x) + wxy * static_cast<float>(y);
      right_y += wxy * static_cast<float>(x) + wyy * static_cast<float>(y);
    }
  }
  const float determinant = xx * yy - xy * xy;
  if (!(determinant > kLeastDeterminant * (xx + yy) * (xx + yy))) return std::nullopt;
  return cv::Point2f((yy * right_x - xy * right_y) / determinant, (xx * right_y - xy * right_x) / determinant);
}

bool IsNear(cv::Point2f offset) {
  return std::abs(offset.x) <= kLargestRefinement && std::abs(offset.y) <= kLargestRefinement;
}

}  // namespace

cv::Point2f RefineCorner(const std::uint8_t* center, int stride) {
  const std::optional<cv::Point2f> first = SolveCorner(center, stride);
  if (!first || !IsNear(*first)) return {0.0F, 0.0F};
  const auto x = static_cast<int>(std::lround(first->x)), y = static_cast<int>(std::lround(first->y));
  if (x == 0 && y == 0) return *first;
  // Once more with the window around the corner itself.
  const std::optional<cv::Point2f> second = SolveCorner(center + static_cast<std::ptrdiff_t>(y) * stride + x, stride);
  if (!second) return *first;
  const cv::Point2f refined = cv::Point2f(static_cast<float>(x), static_cast<float>(y)) + *second;
  return IsNear(refined) ? refined : cv::Point2f(0.0F, 0.0F);
}

}  // namespace pangaea
