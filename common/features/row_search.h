#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <vector>

namespace pangaea {

// The gradient along the rows of an image (Sobel), for comparing patches: indifferent to brightness, and blind to edges
// along the row, which say nothing about disparity. Has a margin, so that blocks may be read past the edges.
class RowGradient {
 public:
  static constexpr int kMargin = 32;
  static constexpr int kZero = 128;         // stored for no gradient
  static constexpr int kUnitsPerLevel = 2;  // stored units per grey level per pixel; steeper than +-63 is cut off

  // `image` is CV_8UC1. Buffers are reused.
  void Build(const cv::Mat& image);
  int width() const { return view_.cols; }
  int height() const { return view_.rows; }
  const std::uint8_t* row(int y) const { return view_.ptr<std::uint8_t>(y); }

 private:
  cv::Mat buffer_;
  cv::Mat view_;  // of buffer_, without the margin
  std::vector<std::int16_t> column_sums_;
};

// A block of gradients around a pixel, to be found along the rows of another image.
struct GradientBlock {
  static constexpr int kWidth = 12;
  static constexpr int kHeight = 11;
  static constexpr int kLeft = 6;  // columns left of the centre; 5 right of it
  static constexpr int kUnits = kWidth * kHeight * RowGradient::kUnitsPerLevel;  // of cost for 1 grey level per pixel
  static constexpr int kUp = 5;                                                  // rows above the centre; as many below
  std::array<std::array<std::uint8_t, 16>, kHeight> rows{};                      // the last 4 of each are padding

  // Does the block around (x, y) lie inside of the image?
  static bool Fits(const RowGradient& gradient, int x, int y);
  static GradientBlock At(const RowGradient& gradient, int x, int y);
  // Mean magnitude, grey levels per pixel.
  double Texture() const;
};

// Where a block was found.
struct RowMatch {
  int x = 0;
  int y = 0;
  int cost = 0;         // sum of absolute differences
  int second_cost = 0;  // the least outside of the valley of costs around x; INT_MAX where there is nothing else
};

// Finds blocks by the sum of absolute differences. Keeps buffers: one object per thread.
class RowSearch {
 public:
  // Columns first_x to last_x (the block's centre) of the rows y - rows_around to y + rows_around, as far as the block
  // fits. None where it fits nowhere.
  std::optional<RowMatch> Find(const GradientBlock& block, const RowGradient& gradient, int first_x, int last_x, int y,
                               int rows_around);

 private:
  std::vector<std::uint16_t> costs_;  // of one row, in whole groups of 8 columns
  std::vector<std::uint16_t> least_;  // over the rows
};

}  // namespace pangaea
