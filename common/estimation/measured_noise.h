#pragma once

#include <Eigen/Core>
#include <span>

#include "common/estimation/bundle_adjustment.h"
#include "common/geometry/rigid3.h"

namespace pangaea {

// A measurement further off than this many times the 95 % quantile of its noise is a wrong one: about the 99.9 %
// quantile. The 95 % quantile itself would eat up what is right, when the noise is measured anew on what remains.
inline constexpr double kBeyondDoubt = 1.5;

// How exact the measurements of a bundle problem are, as poses and points (index by index those of the problem)
// explain them: the standard deviation of one component in units of the sigmas that the problem gives them. 1 where
// the sigmas are right. What the median point says, of those with three and more observations: neither wrong points nor
// a part of the map that does not fit the rest yet change it much. Infinite where there are no such points.
double MeasuredNoise(const BundleProblem& problem, std::span<const Rigid3d> camera_from_map,
                     std::span<const Eigen::Vector3d> point_in_map);
// At the problem's own poses and points.
double MeasuredNoise(const BundleProblem& problem);

}  // namespace pangaea
