#include "common/features/row_alignment.h"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstdint>

namespace pangaea {
namespace {

constexpr int kRadius = 4;
constexpr int kSide = 2 * kRadius + 1;
constexpr std::size_t kPixels = kSide * kSide;
constexpr int kIterations = 10;
constexpr float kConverged = 0.01F;     // pixels
constexpr float kImageVariance = 9.0F;  // of a pixel's noise, grey levels squared: weighs the priors
constexpr float kLeastGradient = 1.0F;  // root mean square along u, grey levels per pixel
constexpr float kLargestSlant = 1.0F;   // pixels per pixel: steeper surfaces show nothing recognisable

// Patches are padded with zeros to whole groups of lanes, so that sums over them need no remainder loop.
constexpr std::size_t kLanes = 8;
constexpr std::size_t Padded(std::size_t size) { return (size + kLanes - 1) / kLanes * kLanes; }
using Patch = std::array<float, Padded(kPixels)>;

// How the left patch lies in the right image: rows stay rows, sheared and stretched.
struct Warp {
  cv::Point2f center;
  float stretch = 0.0F;  // of u per pixel along u
  float shear = 0.0F;    // of u per pixel along v
};

// Sums in lanes, always in the same order: vectors without -ffast-math, and the same result everywhere.
template <typename Term>
float Sum(Term term) {
  std::array<float, kLanes> sums{};
  for (std::size_t i = 0; i < Padded(kPixels); i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) sums[lane] += term(i + lane);
  }
  return ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]));
}

float Dot(const Patch& a, const Patch& b) {
  return Sum([&](std::size_t i) { return a[i] * b[i]; });
}

void RemoveMean(Patch& patch) {
  for (std::size_t i = kPixels; i < patch.size(); ++i) patch[i] = 0.0F;
  const float mean = Sum([&](std::size_t i) { return patch[i]; }) / static_cast<float>(kPixels);
  for (std::size_t i = 0; i < kPixels; ++i) patch[i] -= mean;
}

bool Fits(const cv::Mat& image, const Warp& warp, int radius) {
  const auto reach_v = static_cast<float>(radius);
  const float reach_u = reach_v * (1.0F + std::abs(warp.stretch) + std::abs(warp.shear));
  return warp.center.x >= reach_u && warp.center.y >= reach_v &&
         warp.center.x < static_cast<float>(image.cols - 1) - reach_u &&
         warp.center.y < static_cast<float>(image.rows - 1) - reach_v;
}

// Bilinear samples of a warped square; the padding is left unset.
template <int Side>
std::array<float, Padded(Side* Side)> Sample(const cv::Mat& image, const Warp& warp) {
  constexpr auto kReach = static_cast<float>(Side / 2);
  const float top = warp.center.y - kReach;
  const int first_row = static_cast<int>(top);
  const float b = top - static_cast<float>(first_row);
  const float step = 1.0F + warp.stretch;
  std::array<float, Padded(Side * Side)> samples;
  for (int y = 0; y < Side; ++y) {
    const std::uint8_t* upper = image.ptr<std::uint8_t>(first_row + y);
    const std::uint8_t* lower = upper + image.step;
    const float left = warp.center.x + warp.shear * (static_cast<float>(y) - kReach) - step * kReach;
    for (int x = 0; x < Side; ++x) {
      const float u = left + step * static_cast<float>(x);
      const int i = static_cast<int>(u);
      const float a = u - static_cast<float>(i);
      const float up = static_cast<float>(upper[i]) + a * static_cast<float>(upper[i + 1] - upper[i]);
      const float down = static_cast<float>(lower[i]) + a * static_cast<float>(lower[i + 1] - lower[i]);
      samples[static_cast<std::size_t>(y * Side + x)] = up + b * (down - up);
    }
  }
  return samples;
}

// The left patch: its values, and how they change with each unknown: shift along u, along v, stretch, shear. All with
// their means removed, since the offset of brightness is free.
struct Template {
  Patch value;
  std::array<Patch, 4> slope;
};

Template MakeTemplate(const cv::Mat& image, cv::Point2f position) {
  constexpr int kWide = kSide + 2;
  const auto wide = Sample<kWide>(image, {.center = position});
  Template result;
  for (std::size_t i = 0; i < kPixels; ++i) {
    const std::size_t at = (i / kSide + 1) * kWide + i % kSide + 1;
    const float du = 0.5F * (wide[at + 1] - wide[at - 1]);
    result.value[i] = wide[at];
    result.slope[0][i] = du;
    result.slope[1][i] = 0.5F * (wide[at + kWide] - wide[at - kWide]);
    result.slope[2][i] = du * static_cast<float>(static_cast<int>(i % kSide) - kRadius);
    result.slope[3][i] = du * static_cast<float>(static_cast<int>(i / kSide) - kRadius);
  }
  RemoveMean(result.value);
  for (Patch& slope : result.slope) RemoveMean(slope);
  return result;
}

Eigen::Vector4f Project(const Template& left, const Patch& patch) {
  return {Dot(left.slope[0], patch), Dot(left.slope[1], patch), Dot(left.slope[2], patch), Dot(left.slope[3], patch)};
}

bool IsPlausible(const Warp& warp, cv::Point2f start, float max_drift) {
  return std::abs(warp.center.x - start.x) <= max_drift && std::abs(warp.center.y - start.y) <= max_drift &&
         std::abs(warp.stretch) <= kLargestSlant && std::abs(warp.shear) <= kLargestSlant;
}

}  // namespace

std::optional<RowAlignment> AlignAlongRow(const cv::Mat& left, cv::Point2f position, const cv::Mat& right,
                                          cv::Point2f start, const RowAlignmentOptions& options) {
  if (!Fits(left, {.center = position}, kRadius + 1)) return std::nullopt;
  const Template wanted = MakeTemplate(left, position);
  Eigen::Matrix4f information;
  for (int i = 0; i < 4; ++i) information.col(i) = Project(wanted, wanted.slope[static_cast<std::size_t>(i)]);
  if (information(0, 0) < kLeastGradient * kLeastGradient * static_cast<float>(kPixels)) return std::nullopt;
  const float slant_weight = kImageVariance / (options.slant_sigma * options.slant_sigma);
  const Eigen::Vector4f prior(0.0F, kImageVariance / (options.row_sigma * options.row_sigma), slant_weight,
                              slant_weight);
  information.diagonal() += prior;
  const Eigen::Matrix4f covariance = information.inverse();
  const Eigen::Vector4f wanted_projected = Project(wanted, wanted.value);
  const float energy = Dot(wanted.value, wanted.value);

  Warp warp{.center = start};
  for (int i = 0; i < kIterations; ++i) {
    if (!Fits(right, warp, kRadius)) return std::nullopt;
    Patch seen = Sample<kSide>(right, warp);
    RemoveMean(seen);
    const float gain = Dot(wanted.value, seen) / energy;
    if (!(gain > 0.0F)) return std::nullopt;
    // The residual seen / gain - wanted is what the slopes make of the warp's error.
    const Eigen::Vector4f deviation(0.0F, warp.center.y - start.y, warp.stretch, warp.shear);
    const Eigen::Vector4f error =
        covariance * (Project(wanted, seen) / gain - wanted_projected + prior.cwiseProduct(deviation));
    warp.center -= cv::Point2f(error[0], error[1]);
    warp.stretch -= error[2];
    warp.shear -= error[3];
    if (!IsPlausible(warp, start, options.max_drift)) return std::nullopt;
    if (std::abs(error[0]) < kConverged) return RowAlignment{warp.center, gain * std::sqrt(energy / Dot(seen, seen))};
  }
  return std::nullopt;
}

}  // namespace pangaea
