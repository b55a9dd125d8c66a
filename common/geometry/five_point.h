#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace pangaea {

// The essential matrices E with second' E first = 0 for five points of two calibrated views (points at z = 1): up to
// ten (Nister, "An efficient solution to the five-point relative pose problem", 2004; solved by the eigenvectors of an
// action matrix as in Stewenius, Engels and Nister, "Recent developments on direct relative orientation", 2006). Works
// for points of a plane as well. Of unit norm. None for degenerate or non-finite points. Both spans have length five.
std::vector<Eigen::Matrix3d> SolveFivePoint(std::span<const Eigen::Vector2d> first,
                                            std::span<const Eigen::Vector2d> second);

}  // namespace pangaea
