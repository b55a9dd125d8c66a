#include "common/features/row_search.h"

#include <algorithm>
#include <climits>
#include <cstdlib>
#include <cstring>

#if defined(__SSE4_1__)
#include <smmintrin.h>
#endif

#include "common/base/check.h"

namespace pangaea {
namespace {

constexpr int kGroup = 8;  // columns whose costs are computed together

#if defined(__SSE4_1__)
inline __m128i Load(const std::uint8_t* bytes) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(bytes)); }

// Costs of 8 neighbouring columns; `corner` is the image pixel under the block's upper left one at the first of them.
void CostsOfGroup(const GradientBlock& block, const std::uint8_t* corner, std::ptrdiff_t stride, std::uint16_t* costs) {
  __m128i sum = _mm_setzero_si128();
  for (int row = 0; row < GradientBlock::kHeight; ++row) {
    const std::uint8_t* pixels = corner + row * stride;
    const __m128i wanted = Load(block.rows[static_cast<std::size_t>(row)].data());
    const __m128i near = Load(pixels), far = Load(pixels + 8);
    // Each adds 8 sums over 4 columns: block columns 0 to 3, 4 to 7, 8 to 11.
    sum = _mm_add_epi16(sum, _mm_mpsadbw_epu8(near, wanted, 0));
    sum = _mm_add_epi16(sum, _mm_mpsadbw_epu8(near, wanted, 5));
    sum = _mm_add_epi16(sum, _mm_mpsadbw_epu8(far, wanted, 2));
  }
  _mm_storeu_si128(reinterpret_cast<__m128i*>(costs), sum);
}
#else
void CostsOfGroup(const GradientBlock& block, const std::uint8_t* corner, std::ptrdiff_t stride, std::uint16_t* costs) {
  for (int column = 0; column < kGroup; ++column) {
    int sum = 0;
    for (int row = 0; row < GradientBlock::kHeight; ++row) {
      const std::uint8_t* pixels = corner + row * stride + column;
      const auto& wanted = block.rows[static_cast<std::size_t>(row)];
      for (int x = 0; x < GradientBlock::kWidth; ++x) sum += std::abs(pixels[x] - wanted[static_cast<std::size_t>(x)]);
    }
    costs[column] = static_cast<std::uint16_t>(sum);
  }
}
#endif

// The two halves of the Sobel filter, in 16 bits so that the compiler uses as many lanes as it can.
void SumColumns(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below,
                std::span<std::int16_t> sums) {
  for (std::size_t x = 0; x < sums.size(); ++x) {
    sums[x] = static_cast<std::int16_t>(above[x] + 2 * here[x] + below[x]);
  }
}

void DifferRow(std::span<const std::int16_t> sums, std::uint8_t* out) {
  constexpr int kShift = 2;  // the Sobel sum is 8 times the gradient
  static_assert((8 >> kShift) == RowGradient::kUnitsPerLevel);
  constexpr std::int16_t kLimit = RowGradient::kZero - 1;
  for (std::size_t x = 1; x + 1 < sums.size(); ++x) {
    const auto difference = static_cast<std::int16_t>(sums[x + 1] - sums[x - 1]);
    const auto units =
        std::clamp(static_cast<std::int16_t>(difference >> kShift), static_cast<std::int16_t>(-kLimit), kLimit);
    out[x] = static_cast<std::uint8_t>(units + RowGradient::kZero);
  }
}

// The least cost outside of the valley around `best`: where costs no longer rise on the way out.
int SecondCost(std::span<const std::uint16_t> costs, std::size_t best) {
  constexpr std::size_t kLeastReach = 2;
  std::size_t left = best, right = best;
  while (left > 0 && (best - left < kLeastReach || costs[left - 1] >= costs[left])) --left;
  while (right + 1 < costs.size() && (right - best < kLeastReach || costs[right + 1] >= costs[right])) ++right;
  int second = INT_MAX;
  for (std::size_t i = 0; i < left; ++i) second = std::min<int>(second, costs[i]);
  for (std::size_t i = right + 1; i < costs.size(); ++i) second = std::min<int>(second, costs[i]);
  return second;
}

}  // namespace

void RowGradient::Build(const cv::Mat& image) {
  PANGAEA_CHECK(image.type() == CV_8UC1);
  buffer_.create(image.rows, image.cols + 2 * kMargin, CV_8UC1);
  view_ = buffer_(cv::Rect(kMargin, 0, image.cols, image.rows));
  const auto width = static_cast<std::size_t>(image.cols);
  column_sums_.resize(width);
  for (int y = 0; y < image.rows; ++y) {
    SumColumns(image.ptr<std::uint8_t>(std::max(y - 1, 0)), image.ptr<std::uint8_t>(y),
               image.ptr<std::uint8_t>(std::min(y + 1, image.rows - 1)), column_sums_);
    std::memset(buffer_.ptr<std::uint8_t>(y), kZero, kMargin + 1);
    std::memset(view_.ptr<std::uint8_t>(y) + width - 1, kZero, kMargin + 1);
    DifferRow(column_sums_, view_.ptr<std::uint8_t>(y));
  }
}

bool GradientBlock::Fits(const RowGradient& gradient, int x, int y) {
  return x >= kLeft && x - kLeft + kWidth <= gradient.width() && y >= kUp && y + kUp < gradient.height();
}

GradientBlock GradientBlock::At(const RowGradient& gradient, int x, int y) {
  GradientBlock block;
  for (int row = 0; row < kHeight; ++row) {
    std::memcpy(block.rows[static_cast<std::size_t>(row)].data(), gradient.row(y - kUp + row) + x - kLeft, kWidth);
  }
  return block;
}

double GradientBlock::Texture() const {
  int sum = 0;
  for (const auto& row : rows) {
    for (std::size_t x = 0; x < kWidth; ++x) sum += std::abs(row[x] - RowGradient::kZero);
  }
  return static_cast<double>(sum) / kUnits;
}

std::optional<RowMatch> RowSearch::Find(const GradientBlock& block, const RowGradient& gradient, int first_x,
                                        int last_x, int y, int rows_around) {
  first_x = std::max(first_x, GradientBlock::kLeft);
  last_x = std::min(last_x, gradient.width() - GradientBlock::kWidth + GradientBlock::kLeft);
  const int first_y = std::max(y - rows_around, GradientBlock::kUp);
  const int last_y = std::min(y + rows_around, gradient.height() - 1 - GradientBlock::kUp);
  if (first_x > last_x || first_y > last_y) return std::nullopt;
  const auto columns = static_cast<std::size_t>(last_x - first_x + 1);
  costs_.resize((columns + kGroup - 1) / kGroup * kGroup);
  const auto stride = static_cast<std::ptrdiff_t>(gradient.row(1) - gradient.row(0));
  RowMatch match{.x = 0, .y = 0, .cost = INT_MAX, .second_cost = INT_MAX};
  for (int row = first_y; row <= last_y; ++row) {
    const std::uint8_t* corner = gradient.row(row - GradientBlock::kUp) + first_x - GradientBlock::kLeft;
    for (std::size_t i = 0; i < columns; i += kGroup) CostsOfGroup(block, corner + i, stride, costs_.data() + i);
    const auto best = std::min_element(costs_.begin(), costs_.begin() + static_cast<std::ptrdiff_t>(columns));
    if (*best < match.cost) {
      match = {.x = first_x + static_cast<int>(best - costs_.begin()), .y = row, .cost = *best, .second_cost = INT_MAX};
    }
    if (row == first_y) {
      least_ = costs_;
    } else {
      std::transform(costs_.begin(), costs_.end(), least_.begin(), least_.begin(),
                     [](std::uint16_t a, std::uint16_t b) { return std::min(a, b); });
    }
  }
  match.second_cost = SecondCost(std::span(least_).first(columns), static_cast<std::size_t>(match.x - first_x));
  return match;
}

}  // namespace pangaea
