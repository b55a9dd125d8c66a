#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace pangaea {

struct ImageSensorOptions {
  double read_noise = 1.0;    // grey levels, independent of the light
  double shot_noise = 0.012;  // variance per grey level of light: brighter pixels are noisier
  double dark_level = 3.0;    // grey levels that a covered lens shows
  double vignetting = 0.18;   // share of the light lost in the corners
};

// What a sensor makes of light: vignetting, exposure, noise, 8 bits.
class ImageSensor {
 public:
  ImageSensor(int width, int height, const ImageSensorOptions& options);

  // `light` as Renderer gives it (32-bit floats), multiplied by `exposure`. The noise is a function of `seed` alone.
  cv::Mat Expose(const cv::Mat& light, double exposure, std::uint64_t seed) const;
  // A covered lens.
  cv::Mat Dark(std::uint64_t seed) const;

 private:
  ImageSensorOptions options_;
  cv::Mat gain_;                     // 32-bit floats
  std::vector<float> sigma_;         // by grey level
  std::vector<float> normal_table_;  // standard normal numbers, read from a random place for every row
};

}  // namespace pangaea
