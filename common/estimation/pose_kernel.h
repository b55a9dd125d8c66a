#pragma once

#include <cstdint>
#include <span>

#include "common/estimation/kernel_bends.h"
#include "common/estimation/pose_refinement.h"

namespace pangaea {

// The normal equations of a pose, for the perturbation of pose_refinement.h: cost is the sum of the kernel of the
// squared residuals, gradient and information are half its first and second derivative.
struct PoseNormalEquations {
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double cost = 0.0;
};

// Sums the observations whose flag in `active` is not 0. Vectorised over observations, with the widest instructions
// this processor has: results differ in the last digits between processors.
PoseNormalEquations AccumulatePose(const IdealCamera& camera, const Rigid3d& camera_from_map,
                                   std::span<const PoseObservation> observations, std::span<const std::uint8_t> active,
                                   const KernelBends& bends);

}  // namespace pangaea
