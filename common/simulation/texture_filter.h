#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "common/simulation/texture.h"

namespace pangaea {

// How one pixel's footprint on a surface is averaged: `probes` trilinear samples along its longer axis.
struct TextureFilter {
  int probes = 1;
  float level = 0.0F;   // of detail, fractional
  float step_s = 0.0F;  // from probe to probe
  float step_t = 0.0F;
};

// The Jacobian of a surface's (s, t) by the pixel's (column, row).
struct Footprint {
  float s_column, s_row;
  float t_column, t_row;
};

// Base-2 logarithm of a positive number, linear between powers of two: good to 0.09, continuous and monotonic.
inline float RoughLog2(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const float mantissa = std::bit_cast<float>((bits & 0x007fffffU) | 0x3f800000U);
  return static_cast<float>(static_cast<int>(bits >> 23) - 127) + mantissa - 1.0F;
}

// A pixel on the floor far away is a long ellipse on it: averaging along its longer axis keeps the shorter one sharp
// (Heckbert 1989 gives the axes).
inline TextureFilter ChooseFilter(const Texture& texture, const Footprint& f, int max_probes) {
  // Slightly sharper than one texel a pixel: the bilinear kernel is softer than a pixel.
  constexpr float kSharpening = 0.85F;
  const float width = kSharpening * static_cast<float>(texture.width());
  const float height = kSharpening * static_cast<float>(texture.height());
  const float sc = f.s_column * width, sr = f.s_row * width;
  const float tc = f.t_column * height, tr = f.t_row * height;
  const float a = sc * sc + tc * tc;
  const float b = sr * sr + tr * tr;
  const float c = sc * sr + tc * tr;
  const float half_difference = 0.5F * (a - b);
  const float root = std::sqrt(half_difference * half_difference + c * c);
  const float major = std::sqrt(0.5F * (a + b) + root);
  const float minor = std::sqrt(std::max(0.5F * (a + b) - root, 1e-6F * major * major));
  TextureFilter filter;
  const float ratio = std::max(major, 1.0F) / std::max(minor, 1.0F);
  filter.probes = std::clamp(static_cast<int>(ratio + 0.5F), 1, max_probes);
  const float along = std::max(major / static_cast<float>(filter.probes), 1.0F);
  // Where the probes' own footprint is still longer than wide, between its two axes.
  const float probe = along > minor ? std::sqrt(along * std::max(minor, 0.5F * along)) : minor;
  filter.level = std::clamp(RoughLog2(std::max(probe, 1.0F)), 0.0F, static_cast<float>(texture.level_count() - 1));
  if (filter.probes > 1) {
    // The longer axis in the image, as the eigenvector of the larger eigenvalue; the better conditioned of two forms.
    float column = half_difference > 0.0F ? half_difference + root : c;
    float row = half_difference > 0.0F ? c : root - half_difference;
    const float scale = 1.0F / (static_cast<float>(filter.probes) * std::sqrt(column * column + row * row));
    column *= scale;
    row *= scale;
    filter.step_s = f.s_column * column + f.s_row * row;
    filter.step_t = f.t_column * column + f.t_row * row;
  }
  return filter;
}

// s and t in [0, 1].
inline float SampleBilinear(const Texture::Level& level, float s, float t) {
  const float x = s * static_cast<float>(level.width) + 0.5F;
  const float y = t * static_cast<float>(level.height) + 0.5F;
  const int column = static_cast<int>(x);
  const int row = static_cast<int>(y);
  const float fx = x - static_cast<float>(column);
  const float fy = y - static_cast<float>(row);
  const std::uint8_t* upper = level.origin + (row - 1) * level.stride + column - 1;
  const std::uint8_t* lower = upper + level.stride;
  const auto u0 = static_cast<float>(upper[0]), u1 = static_cast<float>(upper[1]);
  const auto l0 = static_cast<float>(lower[0]), l1 = static_cast<float>(lower[1]);
  const float top = u0 + fx * (u1 - u0);
  const float bottom = l0 + fx * (l1 - l0);
  return top + fy * (bottom - top);
}

inline float SampleTrilinear(const Texture& texture, float level, float s, float t) {
  const int finer = static_cast<int>(level);
  const float fraction = level - static_cast<float>(finer);
  const float value = SampleBilinear(texture.level(finer), s, t);
  if (fraction == 0.0F) return value;
  return value + fraction * (SampleBilinear(texture.level(finer + 1), s, t) - value);
}

inline float SampleFiltered(const Texture& texture, const TextureFilter& filter, float s, float t) {
  const float offset = 0.5F * static_cast<float>(filter.probes - 1);
  float sum = 0.0F;
  for (int i = 0; i < filter.probes; ++i) {
    const float along = static_cast<float>(i) - offset;
    sum += SampleTrilinear(texture, filter.level, std::clamp(s + along * filter.step_s, 0.0F, 1.0F),
                           std::clamp(t + along * filter.step_t, 0.0F, 1.0F));
  }
  return sum / static_cast<float>(filter.probes);
}

}  // namespace pangaea
