#pragma once

#include <array>
#include <cstddef>

namespace pangaea {

// The newest durations of something, milliseconds. A value.
class LatencyWindow {
 public:
  void Add(double milliseconds);
  // The value that the given share (0 to 1) of the window does not exceed; 0 while there is none.
  double Quantile(double share) const;
  std::size_t count() const { return count_; }

 private:
  static constexpr std::size_t kSize = 256;
  std::array<float, kSize> values_{};
  std::size_t count_ = 0;  // ever added
};

}  // namespace pangaea
