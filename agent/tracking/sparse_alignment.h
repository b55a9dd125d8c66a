#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "common/features/patch_pyramid.h"
#include "common/geometry/ideal_camera.h"
#include "common/geometry/rigid3.h"

namespace pangaea {

struct SparseAlignmentOptions {
  int coarsest_level = 4;        // of the factor-2 pyramid: 16 pixels of flow are one pixel there
  int finest_level = 2;          // finer levels are the patch alignment's business
  int max_iterations = 10;       // of Gauss-Newton, per level
  double converged_step = 1e-4;  // metres and radians: a small fraction of a pixel
  double huber = 10.0;           // grey levels
  int min_points = 12;           // fewer do not determine six parameters against noise
};

// Estimates current_from_previous from the two images alone, without finding any feature: the brightness around points
// of known depth must agree (Forster et al., "SVO", 2014, section IV-A; inverse compositional). `points_in_previous`
// are in the camera frame of the previous image. Survives fast rotations that a motion model does not predict.
// Returns the refined motion, or nothing when too few points stay visible or the brightness agrees no better
// than for `initial`.
std::optional<Rigid3d> AlignSparsely(const ImagePyramid& previous, const ImagePyramid& current,
                                     const IdealCamera& camera, std::span<const Eigen::Vector3d> points_in_previous,
                                     const Rigid3d& initial, const SparseAlignmentOptions& options);

}  // namespace pangaea
