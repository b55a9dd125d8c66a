#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/estimation/pose_refinement.h"

namespace pangaea {

struct AbsolutePoseOptions {
  PoseRefinementOptions refinement;
  double confidence = 0.999;  // of having drawn one sample free of outliers
  int max_iterations = 300;   // minimal samples
  int min_inliers = 12;       // a pose on fewer is a coincidence

  Status Check() const;
};

struct AbsolutePose {
  RefinedPose pose;
  std::vector<std::uint8_t> inliers;  // per observation
  int iterations = 0;                 // minimal samples drawn
};

// The camera's pose from point matches of which many may be wrong, without a first guess: RANSAC on three-point
// poses, each better one polished by RefinePose. The same seed gives the same answer. Nothing when no pose
// reaches options.min_inliers.
std::optional<AbsolutePose> EstimateAbsolutePose(const IdealCamera& camera,
                                                 std::span<const PoseObservation> observations,
                                                 const AbsolutePoseOptions& options, std::uint64_t seed);

}  // namespace pangaea
