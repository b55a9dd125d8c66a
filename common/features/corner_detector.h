#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace pangaea {

struct Corner {
  std::int16_t x = 0;
  std::int16_t y = 0;
  // The largest threshold at which the pixel is a FAST-9 corner: the least of the differences to the centre over the
  // best arc of 9 pixels on the circle of 16.
  std::uint8_t score = 0;
  bool operator==(const Corner&) const = default;
};

// FAST-9 corners (Rosten and Drummond 2006) whose score is above `threshold` and the largest of the 3 x 3 around them,
// row by row. `border` pixels, at least 4, on every side of the image give none.
class CornerDetector {
 public:
  void Detect(const cv::Mat& image, int threshold, int border, std::vector<Corner>& corners);

 private:
  std::vector<std::uint8_t> scores_;  // three rows in turn
};

}  // namespace pangaea
