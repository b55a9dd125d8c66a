#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/rigid3.h"

namespace pangaea {

// The essential matrix E with second' E first = 0 of two calibrated views (points at z = 1), by the eight-point
// algorithm with Hartley's conditioning; its singular values are made 1, 1, 0. The spans have equal lengths, at least
// eight. Nothing when the points do not determine it, as those of a plane.
std::optional<Eigen::Matrix3d> FitEssentialMatrix(std::span<const Eigen::Vector2d> first,
                                                  std::span<const Eigen::Vector2d> second);

Eigen::Matrix3d EssentialMatrixOf(const Rigid3d& second_from_first);

// The four second_from_first, with a translation of unit length, that an essential matrix leaves possible (Hartley and
// Zisserman, "Multiple View Geometry", 2004, result 9.19). In one of them points lie in front of both cameras.
std::vector<Rigid3d> DecomposeEssentialMatrix(const Eigen::Matrix3d& essential);

}  // namespace pangaea
