#pragma once

#include <Eigen/Core>
#include <array>

#include "common/geometry/rigid3.h"

namespace pangaea {

// The poses that explain three bearings of three points; the first `count` of `camera_from_map` are valid.
struct ThreePointPoses {
  std::array<Rigid3d, 4> camera_from_map;
  int count = 0;
};

// `bearings` are unit vectors in the camera frame, `points_in_map` the points they were seen at. Empty when the
// points are collinear or no real solution has all points in front of the camera.
// Persson and Nordberg, "Lambda Twist: An Accurate Fast Robust Perspective Three Point (P3P) Solver", ECCV 2018.
ThreePointPoses SolvePerspectiveThreePoint(const std::array<Eigen::Vector3d, 3>& bearings,
                                           const std::array<Eigen::Vector3d, 3>& points_in_map);

}  // namespace pangaea
