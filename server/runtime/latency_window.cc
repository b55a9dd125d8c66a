#include "server/runtime/latency_window.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pangaea {

void LatencyWindow::Add(double milliseconds) { values_[count_++ % kSize] = static_cast<float>(milliseconds); }

double LatencyWindow::Quantile(double share) const {
  const std::size_t filled = std::min(count_, kSize);
  if (filled == 0) return 0.0;
  std::vector<float> sorted(values_.begin(), values_.begin() + static_cast<std::ptrdiff_t>(filled));
  const auto rank = static_cast<std::ptrdiff_t>(std::lround(share * static_cast<double>(filled - 1)));
  std::nth_element(sorted.begin(), sorted.begin() + rank, sorted.end());
  return sorted[static_cast<std::size_t>(rank)];
}

}  // namespace pangaea
