#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/evaluation/plot.h"

namespace pangaea {

// How points of a scene become pixels of its picture: seen from above, both directions to the same scale.
class PlotView {
 public:
  // The rectangle of the picture that the map fills, pixels.
  struct Box {
    double left = 0.0;
    double top = 0.0;
    double width = 0.0;
    double height = 0.0;
  };

  // The longest extent of the trajectories lies along the box; all of them are inside, and most landmarks.
  PlotView(const PlotScene& scene, const Box& box);

  // Horizontal, vertical (upwards) and height coordinate of a point, metres.
  Eigen::Vector3d ToPlane(const Eigen::Vector3d& point) const { return axes_.transpose() * (point - center_); }
  Eigen::Vector2d ToPixel(const Eigen::Vector2d& in_plane) const;
  Eigen::Vector2d ToPixel(const Eigen::Vector3d& point) const {
    return ToPixel(Eigen::Vector2d(ToPlane(point).head<2>()));
  }
  bool Contains(const Eigen::Vector2d& pixel) const;
  // Corners of the box, metres in the plane.
  Eigen::Vector2d low() const { return middle_ - half_size(); }
  Eigen::Vector2d high() const { return middle_ + half_size(); }
  const Box& box() const { return box_; }
  double pixels_per_metre() const { return pixels_per_metre_; }

 private:
  Eigen::Vector2d half_size() const { return Eigen::Vector2d(box_.width, box_.height) / (2.0 * pixels_per_metre_); }

  Box box_;
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes_ = Eigen::Matrix3d::Identity();  // columns: right, up in the picture, towards the viewer
  Eigen::Vector2d middle_ = Eigen::Vector2d::Zero();
  double pixels_per_metre_ = 1.0;
};

}  // namespace pangaea
