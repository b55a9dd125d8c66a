#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "common/base/result.h"
#include "common/geometry/ideal_camera.h"
#include "common/geometry/reprojection.h"
#include "common/geometry/similarity3.h"

namespace pangaea {

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

// A point as one side knows it, and a camera of that side that saw it.
struct Sighting {
  Eigen::Vector3d point;        // in the side's frame, held fixed
  IdealCamera camera;           //
  Rigid3d camera_from_side;     // lengths of the side
  Eigen::Vector3d measurement;  // ideal pixel (u, v, u_right); u_right < 0: monocular
  double inverse_sigma = 1.0;   // 1 / pixels
};

// One point that two sides know, each in its own frame and scale.
struct SightingPair {
  Sighting source;
  Sighting target;
};

// Squared reprojection errors of a pair, in sigmas: of the source's point where the target saw it, and of the target's
// point where the source saw it. Infinite for a point behind the camera.
struct PairErrors {
  double in_target = 0.0;
  double in_source = 0.0;
};
PairErrors ErrorsOf(const SightingPair& pair, const Similarity3d& target_from_source,
                    const Similarity3d& source_from_target);

struct SimilarityRefinementOptions {
  // Whether the scale is estimated; without, that of the first guess stays.
  bool with_scale = true;
  // Squared errors, in sigmas, beyond which a pair is an outlier, in either image. Huber's kernel bends at their roots.
  double monocular_chi2 = kMonocularChi2;
  double stereo_chi2 = kStereoChi2;
  int rounds = 3;                // of optimising the inliers and then judging every pair anew
  int max_iterations = 10;       // Levenberg-Marquardt steps in a round
  double step_tolerance = 1e-3;  // in standard deviations of the motion: a shorter step ends a round
  std::size_t min_inliers = 6;   // with fewer there is no motion

  Status Check() const;
};

struct RefinedSimilarity {
  Similarity3d target_from_source;
  std::size_t inliers = 0;
  double mean_squared_error = 0.0;  // of the inliers, in sigmas, per image
  // H = sum J' Omega J over the inliers, without kernel, for the perturbation Perturb(e, target_from_source). Without
  // scale its last row and column are 0.
  Matrix7d information = Matrix7d::Zero();
};

// The similarity by e = (translation, rotation, logarithm of the scale) beyond target_from_source, in the target frame.
Similarity3d Perturb(const Vector7d& e, const Similarity3d& target_from_source);

// The motion that minimises the robust reprojection errors in both images (Elvira et al. 2019, "Seamless map merging";
// Mur-Artal et al. 2015, section VII.B): Levenberg-Marquardt with analytic Jacobians. `inliers` has the length of
// `pairs`; on entry it says which pairs to begin with, on return which ones fit (none where there is no motion).
// Nothing when the inliers become fewer than options.min_inliers or do not determine the motion.
std::optional<RefinedSimilarity> RefineSimilarity(std::span<const SightingPair> pairs, const Similarity3d& initial,
                                                  const SimilarityRefinementOptions& options,
                                                  std::span<std::uint8_t> inliers);

}  // namespace pangaea
