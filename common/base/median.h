#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace pangaea {

// The middle one of the values by size, of an even number of them the upper of the two; `otherwise` where there are
// none.
inline double Median(std::vector<double> values, double otherwise = 0.0) {
  if (values.empty()) return otherwise;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace pangaea
