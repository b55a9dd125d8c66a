#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/estimation/bundle_adjustment.h"
#include "common/estimation/kernel_bends.h"

namespace pangaea {

// What the back ends of SolveBundle share: one minimisation over a fixed set of observations.
struct BundlePhase {
  const BundleProblem& problem;
  const BundleOptions& options;
  std::span<const std::uint8_t> active;  // per observation; the others do not count
  KernelBends bends;
  int iterations;
};

// Where the variables are; both lists have the problem's lengths.
struct BundleState {
  std::vector<Rigid3d> camera_from_map;
  std::vector<Eigen::Vector3d> point_in_map;
};

struct PhaseOutcome {
  double initial_cost = 0.0;
  double final_cost = 0.0;
  int iterations = 0;
  bool converged = false;
  bool cancelled = false;
};

// Each moves `state` to a (nearly) least cost and leaves what is fixed, or without active observation, as it is.
PhaseOutcome RunLocalPhase(const BundlePhase& phase, BundleState& state);
PhaseOutcome RunCeresPhase(const BundlePhase& phase, BundleState& state);

}  // namespace pangaea
