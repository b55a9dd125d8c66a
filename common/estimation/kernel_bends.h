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

// Where the kernel bends once the outliers are gone: at this share of the root of the threshold of the outliers. Most
// of what is left is several times better than its sigma, and some is not: least squares would follow the few
// (docs/decisions/0032-narrow-kernel.md).
inline constexpr double kNarrowShare = 0.13;

// `share`: kLeastShare or more; infinity is no kernel. Smaller ones would leave nothing to divide by.
inline constexpr double kLeastShare = 1e-6;
inline KernelBends Narrowed(const KernelBends& thresholds, double share) {
  const auto narrowed = [share](double threshold) { return std::min(share * share * threshold, kNoKernel.monocular); };
  return {narrowed(thresholds.monocular), narrowed(thresholds.stereo)};
}

}  // namespace pangaea
