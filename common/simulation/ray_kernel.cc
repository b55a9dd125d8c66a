#include "common/simulation/ray_kernel.h"

#include <cstring>

#include "common/simulation/wide_clone.h"

namespace pangaea {
namespace {

// Adds `weight` times the bilinear value at (s, t) to `values`. Three plain loops: the first and the last become vector
// code, only the loads between them go one by one.
inline __attribute__((always_inline)) void AddBilinear(const Texture::Level& level, const float* s, const float* t,
                                                       float weight, float* values) {
  const auto width = static_cast<float>(level.width);
  const auto height = static_cast<float>(level.height);
  const int stride = level.stride;
  const int origin = -stride - 1;
  float fraction_x[kRun], fraction_y[kRun];
  int offset[kRun];
  std::uint32_t texels[kRun];
  for (int i = 0; i < kRun; ++i) {
    const float x = s[i] * width + 0.5F;
    const float y = t[i] * height + 0.5F;
    const int column = static_cast<int>(x);
    const int row = static_cast<int>(y);
    fraction_x[i] = x - static_cast<float>(column);
    fraction_y[i] = y - static_cast<float>(row);
    offset[i] = row * stride + column + origin;
  }
  for (int i = 0; i < kRun; ++i) {
    std::uint16_t upper = 0;
    std::uint16_t lower = 0;
    std::memcpy(&upper, level.origin + offset[i], 2);
    std::memcpy(&lower, level.origin + offset[i] + stride, 2);
    texels[i] = upper | static_cast<std::uint32_t>(lower) << 16;
  }
  for (int i = 0; i < kRun; ++i) {
    const auto packed = static_cast<std::int32_t>(texels[i]);
    const auto u0 = static_cast<float>(packed & 255), u1 = static_cast<float>(packed >> 8 & 255);
    const auto l0 = static_cast<float>(packed >> 16 & 255), l1 = static_cast<float>(packed >> 24 & 255);
    const float top = u0 + fraction_x[i] * (u1 - u0);
    const float bottom = l0 + fraction_x[i] * (l1 - l0);
    values[i] += weight * (top + fraction_y[i] * (bottom - top));
  }
}

}  // namespace

PANGAEA_WIDE_CLONE
void IntersectSurface(const PreparedSurface& surface, std::int32_t id, int count, const float* x, const float* y,
                      const Hits& hits) {
  const PreparedSurface p = surface;
  float* __restrict__ inverse_depth = hits.inverse_depth;
  std::int32_t* __restrict__ nearest = hits.surface;
  for (int i = 0; i < count; ++i) {
    const float w = p.w[0] * x[i] + p.w[1] * y[i] + p.w[2];
    const float s = p.s[0] * x[i] + p.s[1] * y[i] + p.s[2];
    const float t = p.t[0] * x[i] + p.t[1] * y[i] + p.t[2];
    const bool hit = (s >= 0.0F) & (t >= 0.0F) & (s <= w) & (t <= w) & (w > inverse_depth[i]);
    inverse_depth[i] = hit ? w : inverse_depth[i];
    nearest[i] = hit ? id : nearest[i];
  }
}

PANGAEA_WIDE_CLONE
void ShadeRun(const PreparedSurface& surface, const Texture& texture, const TextureFilter& filter, const float* x,
              const float* y, float* values) {
  const PreparedSurface p = surface;
  float s[kRun], t[kRun], probe_s[kRun], probe_t[kRun], sum[kRun];
  for (int i = 0; i < kRun; ++i) {
    const float depth = 1.0F / (p.w[0] * x[i] + p.w[1] * y[i] + p.w[2]);
    s[i] = (p.s[0] * x[i] + p.s[1] * y[i] + p.s[2]) * depth;
    t[i] = (p.t[0] * x[i] + p.t[1] * y[i] + p.t[2]) * depth;
    sum[i] = 0.0F;
  }
  const int finer = static_cast<int>(filter.level);
  const float fraction = filter.level - static_cast<float>(finer);
  const float share = 1.0F / static_cast<float>(filter.probes);
  for (int probe = 0; probe < filter.probes; ++probe) {
    const float along = static_cast<float>(probe) - 0.5F * static_cast<float>(filter.probes - 1);
    for (int i = 0; i < kRun; ++i) {
      const float at_s = s[i] + along * filter.step_s;
      const float at_t = t[i] + along * filter.step_t;
      const float low_s = at_s < 0.0F ? 0.0F : at_s;
      const float low_t = at_t < 0.0F ? 0.0F : at_t;
      probe_s[i] = low_s > 1.0F ? 1.0F : low_s;
      probe_t[i] = low_t > 1.0F ? 1.0F : low_t;
    }
    AddBilinear(texture.level(finer), probe_s, probe_t, share * (1.0F - fraction), sum);
    if (fraction > 0.0F) AddBilinear(texture.level(finer + 1), probe_s, probe_t, share * fraction, sum);
  }
  for (int i = 0; i < kRun; ++i) values[i] = sum[i];
}

}  // namespace pangaea
