#pragma once

#include <algorithm>
#include <limits>

namespace pangaea {

// Huber's kernel is quadratic up to these squared residuals (in sigmas), linear beyond.
struct KernelBends {
  double monocular;
  double stereo;

  bool operator==(const KernelBends&) const = default;
};

// Nothing bends: plain least squares. Finite, because kernels divide by their bends.
inline constexpr KernelBends kNoKernel{std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};

// Where the kernel bends once the outliers are gone, as a share of the root of the outliers' threshold. Most of what is
// left is several times better than its sigma, and some is not: least squares would follow the few
// (docs/decisions/0032-narrow-kernel.md).
inline constexpr double kNarrowKernel = 0.13;

// `share` is positive; infinity is no kernel.
inline KernelBends Narrowed(const KernelBends& outliers, double share) {
  const auto narrowed = [share](double threshold) { return std::min(share * share * threshold, kNoKernel.monocular); };
  return {narrowed(outliers.monocular), narrowed(outliers.stereo)};
}

}  // namespace pangaea
