#pragma once

#include <optional>

#include "common/estimation/bundle_adjustment.h"

namespace pangaea {

struct VergenceEstimate {
  double vergence = 0.0;  // radians, beyond what the measurements are made with (common/geometry/vergence.h)
  double sigma = 0.0;     // radians: its standard deviation, if those of the measurements are right
};

// The vergence with which poses and points explain what both cameras saw best. Disparities that are all too small or
// too large contradict the motion: they scale near and far points differently, while the left camera alone tells how
// the depths of all points are to each other. So few parameters need no solver of their own: the adjusted cost at the
// vergence and one pixel to either side of it is a parabola, whose bottom is the estimate and whose curvature is
// 1 / sigma², and the next round begins there, until the last moves it no more (Newton on the profile of the cost).
//
// `problem` should hold one pose fixed and no more: others would hold the scale that wrong disparities gave them. Its
// cameras are of one rig. Nothing where no observation has depth, an adjustment fails, or the rounds find no bottom.
// Errors of the options: see SolveBundle; a second phase without outliers is left out.
std::optional<VergenceEstimate> EstimateVergence(const BundleProblem& problem, BundleOptions options);

}  // namespace pangaea
