#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>

#include "common/base/result.h"
#include "common/estimation/kernel_bends.h"
#include "common/geometry/ideal_camera.h"
#include "common/geometry/reprojection.h"
#include "common/geometry/rigid3.h"

namespace pangaea {

// A map point (held fixed) and where it was seen.
struct PoseObservation {
  Eigen::Vector3d point_in_map;
  Eigen::Vector3d measurement;  // ideal pixel (u, v, u_right); u_right < 0: monocular
  double inverse_sigma = 1.0;   // 1 / pixels
};

struct PoseRefinementOptions {
  // Squared residuals, in sigmas, beyond which an observation is an outlier. In the first rounds the Huber kernel
  // bends at their roots.
  double monocular_chi2 = kMonocularChi2;
  double stereo_chi2 = kStereoChi2;
  // Rounds of optimising the inliers and then judging every observation anew.
  int rounds = 4;
  // In the last this many rounds, when outliers are gone, it bends at `narrow_share` of their roots.
  int rounds_with_narrow_kernel = 2;
  double narrow_share = kNarrowShare;  // infinity: no kernel in these rounds
  int max_iterations = 10;             // Levenberg-Marquardt steps in a round
  // A shorter step ends a round: in standard deviations of the pose, as the kernel weighs what it rests on.
  double step_tolerance = 1e-3;
  int min_inliers = 6;  // with fewer there is no pose

  Status Check() const;
};

// What is known of the pose beforehand: the error Log(camera_from_map * prior^-1) has this information matrix.
struct PosePrior {
  Rigid3d camera_from_map;
  Matrix6d information = Matrix6d::Zero();
};

struct RefinedPose {
  Rigid3d camera_from_map;
  int inliers = 0;
  // H = sum J' Omega J over the inliers (and the prior's), without kernel, for the perturbation
  // camera_from_map <- Exp(e) * camera_from_map with e = (translation, rotation). What least squares would know of the
  // pose: less than is known where most are better than their sigma, a little more where all are as it says.
  Matrix6d information = Matrix6d::Zero();
  double mean_squared_error = 0.0;  // of the inliers, in sigmas, per observation
  bool converged = false;           // the last round ended by its step, not by its iteration limit
};

// Robust camera pose from points held fixed: Levenberg-Marquardt with analytic Jacobians, in the calling thread,
// without allocation. `inliers` has the length of `observations`; each flag is set to 0 or 1 (all 0 when
// there is no pose). Non-finite observations and those with inverse_sigma <= 0 are outliers.
// Nothing when the inliers are fewer than options.min_inliers or do not determine the pose.
std::optional<RefinedPose> RefinePose(const IdealCamera& camera, const Rigid3d& initial_camera_from_map,
                                      std::span<const PoseObservation> observations,
                                      const PoseRefinementOptions& options, std::span<std::uint8_t> inliers,
                                      const std::optional<PosePrior>& prior = std::nullopt);

// The standard deviations (x, y, z, map units; in the camera frame) of the camera's position that an information
// matrix leaves: the roots of the translation part of diag(H^-1) (Elvira et al., "ORBSLAM-Atlas", 2019, section
// "Camera pose observability"). Infinite where H is singular.
Eigen::Vector3d TranslationSigmas(const Matrix6d& information);

}  // namespace pangaea
