#pragma once

#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <random>

#include "common/geometry/ideal_camera.h"
#include "common/geometry/rigid3.h"

namespace pangaea {

inline IdealCamera SmallCamera() { return IdealCamera{320, 240, 250.0, 250.0, 159.5, 119.5, 0.1}; }

// A wall at z = depth of the map frame with a random, smooth texture, and what cameras see of it.
class TexturedPlane {
 public:
  TexturedPlane(double depth, std::uint64_t seed) : depth_(depth), texture_(kSize, kSize, CV_8UC1) {
    std::mt19937_64 random(seed);
    std::uniform_int_distribution<int> grey(0, 255);
    for (int row = 0; row < kSize; ++row) {
      for (int column = 0; column < kSize; ++column) {
        texture_.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>(grey(random));
      }
    }
    // Detail of several sizes, as real surfaces have it.
    cv::Mat fine;
    cv::Mat coarse;
    cv::GaussianBlur(texture_, fine, {}, 3.0);
    cv::GaussianBlur(texture_, coarse, {}, 9.0);
    cv::addWeighted(fine, 1.0, coarse, 3.0, -384.0, texture_);
    cv::normalize(texture_, texture_, 0, 255, cv::NORM_MINMAX);
  }

  Eigen::Vector3d PointAt(const IdealCamera& camera, const Rigid3d& camera_from_map, double u, double v) const {
    const Rigid3d map_from_camera = camera_from_map.Inverse();
    const Eigen::Vector3d ray = map_from_camera.rotation() * camera.Unproject({u, v});
    const double along = (depth_ - map_from_camera.translation().z()) / ray.z();
    return map_from_camera.translation() + along * ray;
  }

  cv::Mat Render(const IdealCamera& camera, const Rigid3d& camera_from_map) const {
    cv::Mat columns(camera.height, camera.width, CV_32FC1);
    cv::Mat rows(camera.height, camera.width, CV_32FC1);
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const Eigen::Vector3d point = PointAt(camera, camera_from_map, u, v);
        columns.at<float>(v, u) = static_cast<float>(point.x() / kMetresPerTexel + 0.5 * kSize);
        rows.at<float>(v, u) = static_cast<float>(point.y() / kMetresPerTexel + 0.5 * kSize);
      }
    }
    cv::Mat image;
    cv::remap(texture_, image, columns, rows, cv::INTER_CUBIC, cv::BORDER_REFLECT);
    return image;
  }

 private:
  static constexpr int kSize = 1600;
  static constexpr double kMetresPerTexel = 0.006;

  double depth_;
  cv::Mat texture_;
};

}  // namespace pangaea
