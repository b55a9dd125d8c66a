#pragma once

#include <Eigen/Core>

namespace pangaea {

// The virtual, undistorted (for stereo: rectified) left camera that all observations refer to. Pixels have their
// centre at integer coordinates; the optical axis is +z, x right, y down, in the `camera` frame.
struct IdealCamera {
  int width = 0;          // pixels
  int height = 0;         // pixels
  double focal_x = 0.0;   // pixels
  double focal_y = 0.0;   // pixels
  double center_x = 0.0;  // pixels
  double center_y = 0.0;  // pixels
  // Distance to the virtual right camera along +x, metres; 0 where there is none. u_right = u - focal_x * baseline / z.
  double baseline = 0.0;

  bool is_stereo() const { return baseline > 0.0; }
  // Pixel of a point in the camera frame; z must be > 0.
  Eigen::Vector2d Project(const Eigen::Vector3d& point_in_camera) const {
    return {focal_x * point_in_camera.x() / point_in_camera.z() + center_x,
            focal_y * point_in_camera.y() / point_in_camera.z() + center_y};
  }
  // The point of the pixel's ray at z = 1, in the camera frame.
  Eigen::Vector3d Unproject(const Eigen::Vector2d& pixel) const {
    return {(pixel.x() - center_x) / focal_x, (pixel.y() - center_y) / focal_y, 1.0};
  }
  bool Contains(const Eigen::Vector2d& pixel, double border = 0.0) const {
    return pixel.x() >= border && pixel.y() >= border && pixel.x() < width - border && pixel.y() < height - border;
  }
  bool operator==(const IdealCamera&) const = default;
};

}  // namespace pangaea
