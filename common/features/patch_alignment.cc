#include "common/features/patch_alignment.h"

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
constexpr float kImageVariance = 9.0F;  // of a pixel's noise, grey levels squared: weighs the row prior
constexpr float kLeastGradient = 1.0F;  // root mean square along u, grey levels per pixel

using Patch = std::array<float, kPixels>;

bool Fits(const cv::Mat& image, cv::Point2f p, int radius) {
  const auto reach = static_cast<float>(radius);
  return p.x >= reach && p.y >= reach && p.x < static_cast<float>(image.cols - radius - 1) &&
         p.y < static_cast<float>(image.rows - radius - 1);
}

// Bilinear samples of the square of Side pixels around p.
template <int Side>
std::array<float, Side * Side> Sample(const cv::Mat& image, cv::Point2f p) {
  const int x0 = static_cast<int>(p.x), y0 = static_cast<int>(p.y);
  const float a = p.x - static_cast<float>(x0), b = p.y - static_cast<float>(y0);
  const float w00 = (1 - a) * (1 - b), w01 = a * (1 - b), w10 = (1 - a) * b, w11 = a * b;
  std::array<float, Side * Side> samples;
  for (int y = 0; y < Side; ++y) {
    const std::uint8_t* upper = image.ptr<std::uint8_t>(y0 - Side / 2 + y) + x0 - Side / 2;
    const std::uint8_t* lower = upper + image.step;
    float* out = samples.data() + y * Side;
    for (int x = 0; x < Side; ++x) {
      out[x] = w00 * static_cast<float>(upper[x]) + w01 * static_cast<float>(upper[x + 1]) +
               w10 * static_cast<float>(lower[x]) + w11 * static_cast<float>(lower[x + 1]);
    }
  }
  return samples;
}

void RemoveMean(Patch& patch) {
  float sum = 0.0F;
  for (const float value : patch) sum += value;
  const float mean = sum / static_cast<float>(kPixels);
  for (float& value : patch) value -= mean;
}

float Dot(const Patch& a, const Patch& b) {
  float sum = 0.0F;
  for (std::size_t i = 0; i < kPixels; ++i) sum += a[i] * b[i];
  return sum;
}

// The patch in the first image: values and gradients, each with its mean removed since the offset of brightness is
// free.
struct Template {
  Patch value, du, dv;
};

Template MakeTemplate(const cv::Mat& image, cv::Point2f position) {
  constexpr int kWide = kSide + 2;
  const auto wide = Sample<kWide>(image, position);
  Template result;
  for (std::size_t i = 0; i < kPixels; ++i) {
    const std::size_t at = (i / kSide + 1) * kWide + i % kSide + 1;
    result.value[i] = wide[at];
    result.du[i] = 0.5F * (wide[at + 1] - wide[at - 1]);
    result.dv[i] = 0.5F * (wide[at + kWide] - wide[at - kWide]);
  }
  RemoveMean(result.value), RemoveMean(result.du), RemoveMean(result.dv);
  return result;
}

}  // namespace

std::optional<PatchAlignment> AlignPatch(const cv::Mat& first, cv::Point2f position, const cv::Mat& second,
                                         cv::Point2f start, float max_drift, float row_sigma) {
  if (!Fits(first, position, kRadius + 1)) return std::nullopt;
  const Template wanted = MakeTemplate(first, position);
  const float uu = Dot(wanted.du, wanted.du), uv = Dot(wanted.du, wanted.dv);
  if (uu < kLeastGradient * kLeastGradient * static_cast<float>(kPixels)) return std::nullopt;
  const float prior = row_sigma > 0.0F ? kImageVariance / (row_sigma * row_sigma) : 0.0F;
  const float vv = Dot(wanted.dv, wanted.dv) + prior;
  const float determinant = uu * vv - uv * uv;
  const float energy = Dot(wanted.value, wanted.value);
  cv::Point2f p = start;
  for (int i = 0; i < kIterations; ++i) {
    if (!Fits(second, p, kRadius)) return std::nullopt;
    Patch seen = Sample<kSide>(second, p);
    RemoveMean(seen);
    const float gain = Dot(wanted.value, seen) / energy;
    if (!(gain > 0.0F)) return std::nullopt;
    // Residual seen / gain - wanted: what the patch shows if it lies this far beyond the sought position.
    const float right_u = Dot(wanted.du, seen) / gain - Dot(wanted.du, wanted.value);
    const float right_v = Dot(wanted.dv, seen) / gain - Dot(wanted.dv, wanted.value) + prior * (p.y - start.y);
    cv::Point2f step(right_u / uu, 0.0F);
    if (row_sigma > 0.0F)
      step = {(vv * right_u - uv * right_v) / determinant, (uu * right_v - uv * right_u) / determinant};
    p -= step;
    if (!(std::abs(p.x - start.x) <= max_drift) || !(std::abs(p.y - start.y) <= max_drift)) return std::nullopt;
    if (step.dot(step) < kConverged * kConverged) {
      return PatchAlignment{p, gain * std::sqrt(energy / Dot(seen, seen))};
    }
  }
  return std::nullopt;
}

}  // namespace pangaea
