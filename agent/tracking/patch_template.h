#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "common/features/patch_pyramid.h"
#include "common/map/ids.h"

namespace pangaea {

// What a landmark looked like in one keyframe: square crops of that keyframe's image pyramid around it, on the level
// that suits the keypoint's octave and on the next coarser one.
struct PatchTemplate {
  static constexpr int kCropSize = 24;  // pixels: an 8 x 8 window survives any rotation and a magnification of 2
  static constexpr int kLevels = 2;
  struct Crop {
    std::array<std::uint8_t, kCropSize * kCropSize> pixels;
    Eigen::Vector2f center;  // the landmark's position in the crop, pixels
  };

  KeyframeId keyframe;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // of the landmark in the keyframe, full resolution
  int octave = 0;                                   // of the keypoint
  int level = 0;                                    // pyramid level of crops[0]; crops[1] is one level coarser
  int levels = 0;                                   // how many crops fitted into the image: 1 or 2
  std::array<Crop, kLevels> crops;
};

// The level of the factor-2 pyramid whose pixel is nearest to that of the octave.
int PyramidLevelOfOctave(int octave);

// Nothing when the crop would leave the image.
std::optional<PatchTemplate> CutTemplate(const ImagePyramid& image, KeyframeId keyframe, const Eigen::Vector2d& pixel,
                                         int octave);

}  // namespace pangaea
