#include "common/simulation/image_sensor.h"

#include <algorithm>
#include <cmath>

#include "common/simulation/random.h"

namespace pangaea {
namespace {

constexpr std::size_t kTableSize = 1 << 16;  // enough that no eye or filter finds the repetition
constexpr std::uint64_t kTableSeed = 20;

}  // namespace

ImageSensor::ImageSensor(int width, int height, const ImageSensorOptions& options)
    : options_(options), gain_(height, width, CV_32F) {
  const double corner = 0.25 * (width * width + height * height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double dx = x - 0.5 * (width - 1);
      const double dy = y - 0.5 * (height - 1);
      gain_.at<float>(y, x) = static_cast<float>(1.0 - options_.vignetting * (dx * dx + dy * dy) / corner);
    }
  }
  for (int level = 0; level < 256; ++level) {
    sigma_.push_back(
        static_cast<float>(std::sqrt(options_.read_noise * options_.read_noise + options_.shot_noise * level)));
  }
  Random random(kTableSeed);
  for (std::size_t i = 0; i < kTableSize + static_cast<std::size_t>(width); ++i) {
    normal_table_.push_back(static_cast<float>(random.Gaussian()));
  }
}

cv::Mat ImageSensor::Expose(const cv::Mat& light, double exposure, std::uint64_t seed) const {
  cv::Mat image(light.rows, light.cols, CV_8U);
  Random random(seed);
  const auto factor = static_cast<float>(exposure);
  for (int y = 0; y < light.rows; ++y) {
    const float* normal = normal_table_.data() + random.Next() % kTableSize;
    const auto* in = light.ptr<float>(y);
    const auto* gain = gain_.ptr<float>(y);
    auto* out = image.ptr<std::uint8_t>(y);
    for (int x = 0; x < light.cols; ++x) {
      const float value = std::min(in[x] * gain[x] * factor, 255.0F);
      const float noisy = value + sigma_[static_cast<std::size_t>(static_cast<int>(value))] * normal[x] + 0.5F;
      out[x] = static_cast<std::uint8_t>(std::clamp(noisy, 0.0F, 255.0F));
    }
  }
  return image;
}

cv::Mat ImageSensor::Dark(std::uint64_t seed) const {
  const cv::Mat light(gain_.rows, gain_.cols, CV_32F, cv::Scalar(options_.dark_level));
  return Expose(light, 1.0, seed);
}

}  // namespace pangaea
