#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/rigid3.h"

namespace pangaea {

// Moves points so that their centroid is the origin and their mean distance from it the square root of two: linear
// estimates from them are then well conditioned (Hartley, "In defense of the eight-point algorithm", 1997).
// normalised = result * (x, y, 1). Nothing for coinciding or non-finite points, or none.
std::optional<Eigen::Matrix3d> ConditioningTransform(std::span<const Eigen::Vector2d> points);

// The H with second ~ H * first for points of a plane seen twice, or of anything seen by a camera that only turned.
// Minimises the algebraic error (direct linear transform with Hartley's conditioning). The spans have equal lengths, at
// least four. Nothing when the points do not determine it.
std::optional<Eigen::Matrix3d> FitHomography(std::span<const Eigen::Vector2d> first,
                                             std::span<const Eigen::Vector2d> second);

// The camera motions that explain a homography between calibrated views (points at z = 1): up to eight
// second_from_first with a translation of unit length (Faugeras and Lustman, "Motion and structure from motion in a
// piecewise planar environment", 1988). Which of them puts the points in front of both cameras is for the caller to
// find out. None where the homography is (nearly) a pure rotation.
std::vector<Rigid3d> DecomposeHomography(const Eigen::Matrix3d& second_from_first);

}  // namespace pangaea
