#include "agent/tracking/patch_template.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "agent/tracking/image_sampling.h"
#include "common/geometry/keypoint.h"

namespace pangaea {
namespace {

bool CutCrop(const cv::Mat& image, const Eigen::Vector2d& center, PatchTemplate::Crop& crop) {
  constexpr int kHalf = PatchTemplate::kCropSize / 2;
  if (!SamplingFits(image, center.x(), center.y(), 0.0)) return false;  // also what is not a number
  const int left = static_cast<int>(std::floor(center.x())) - kHalf + 1;
  const int top = static_cast<int>(std::floor(center.y())) - kHalf + 1;
  if (left < 0 || top < 0 || left + PatchTemplate::kCropSize > image.cols ||
      top + PatchTemplate::kCropSize > image.rows) {
    return false;
  }
  for (int row = 0; row < PatchTemplate::kCropSize; ++row) {
    std::memcpy(crop.pixels.data() + row * PatchTemplate::kCropSize, image.ptr<std::uint8_t>(top + row) + left,
                PatchTemplate::kCropSize);
  }
  crop.center = (center - Eigen::Vector2d(left, top)).cast<float>();
  return true;
}

}  // namespace

int PyramidLevelOfOctave(int octave) {
  static const double kOctavesPerLevel = std::log(2.0) / std::log(kOctaveScale);
  return static_cast<int>(std::lround(octave / kOctavesPerLevel));
}

std::optional<PatchTemplate> CutTemplate(const ImagePyramid& image, KeyframeId keyframe, const Eigen::Vector2d& pixel,
                                         int octave) {
  PatchTemplate result;
  result.keyframe = keyframe;
  result.pixel = pixel;
  result.octave = octave;
  result.level = std::min(PyramidLevelOfOctave(octave), static_cast<int>(image.levels.size()) - 1);
  while (result.levels < PatchTemplate::kLevels &&
         result.level + result.levels < static_cast<int>(image.levels.size())) {
    const int level = result.level + result.levels;
    if (!CutCrop(image.levels[level], LevelFromFull(pixel, level), result.crops[result.levels])) break;
    ++result.levels;
  }
  if (result.levels == 0) return std::nullopt;
  return result;
}

}  // namespace pangaea
