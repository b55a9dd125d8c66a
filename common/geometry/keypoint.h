#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "common/base/descriptor.h"

namespace pangaea {

// Scale of the pyramid on which keypoints are detected: octave o sees the image reduced by kOctaveScale^o.
inline constexpr double kOctaveScale = 1.2;
inline constexpr int kOctaves = 8;

// Keypoint coordinates are whole multiples of this (pixels), so that 16 bits carry them exactly.
inline constexpr float kPixelQuantum = 1.0F / 32.0F;
inline float QuantizePixel(double pixel) { return static_cast<float>(std::nearbyint(pixel * 32.0)) * kPixelQuantum; }

// A point seen in the ideal camera's image, full-resolution pixels.
struct Keypoint {
  float u = 0.0F;
  float v = 0.0F;
  float u_right = -1.0F;  // column in the rectified right image; negative where unknown
  std::uint8_t octave = 0;
  std::uint8_t angle = 0;  // orientation of the patch, in 1/256 turns, from +u towards +v

  bool has_depth() const { return u_right >= 0.0F; }
  bool operator==(const Keypoint&) const = default;
};

// Standard deviation of a keypoint's position, pixels: it grows with the octave's pixel.
inline double OctaveSigma(int octave) { return std::pow(kOctaveScale, octave); }

// The keypoints of one image and their descriptors, index by index.
struct Features {
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;
  bool operator==(const Features&) const = default;
};

}  // namespace pangaea
