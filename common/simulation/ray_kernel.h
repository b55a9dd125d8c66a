#pragma once

#include <cstdint>

#include "common/simulation/texture_filter.h"

namespace pangaea {

// A surface in a camera's frame, ready for rays (x, y, 1). With corner o, edges a and b, the ray meets the plane where
// [a b o]^-1 (x, y, 1)^T = (s, t, 1) / z: three linear functions of (x, y) give (s / z, t / z, 1 / z).
struct PreparedSurface {
  float s[3];  // s / z = s[0] * x + s[1] * y + s[2]
  float t[3];
  float w[3];
};

// The nearest surface met so far by each of a set of rays.
struct Hits {
  float* inverse_depth;   // 0 where nothing was hit
  std::int32_t* surface;  // -1 where nothing was hit
};

// Lets `count` rays at (x, y) meet one surface. The same result on every processor.
void IntersectSurface(const PreparedSurface& surface, std::int32_t id, int count, const float* x, const float* y,
                      const Hits& hits);

// Where a ray meets a surface's plane, s and t kept in [0, 1].
struct SurfacePoint {
  float s, t, depth;
};

inline SurfacePoint Meet(const PreparedSurface& p, float x, float y) {
  const float depth = 1.0F / (p.w[0] * x + p.w[1] * y + p.w[2]);
  return {std::clamp((p.s[0] * x + p.s[1] * y + p.s[2]) * depth, 0.0F, 1.0F),
          std::clamp((p.t[0] * x + p.t[1] * y + p.t[2]) * depth, 0.0F, 1.0F), depth};
}

// Rays shaded together: neighbours in a row that show the same surface and share one filter.
inline constexpr int kRun = 8;

// Grey values of kRun rays at (x, y), all on `surface`.
void ShadeRun(const PreparedSurface& surface, const Texture& texture, const TextureFilter& filter, const float* x,
              const float* y, float* values);

}  // namespace pangaea
