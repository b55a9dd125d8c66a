#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <stop_token>
#include <vector>

#include "common/base/result.h"
#include "common/estimation/kernel_bends.h"
#include "common/geometry/ideal_camera.h"
#include "common/geometry/reprojection.h"
#include "common/geometry/rigid3.h"

namespace pangaea {

struct BundlePose {
  Rigid3d camera_from_map;
  int camera = 0;  // index into BundleProblem::cameras
  bool fixed = false;
};

struct BundlePoint {
  Eigen::Vector3d point_in_map;
  bool fixed = false;
};

struct BundleObservation {
  int pose = 0;                 // index into BundleProblem::poses
  int point = 0;                // index into BundleProblem::points
  Eigen::Vector3d measurement;  // ideal pixel (u, v, u_right); u_right < 0: monocular
  double inverse_sigma = 1.0;   // 1 / pixels
};

// Numbers only: who the poses and points are is the caller's business. Fix at least one pose, or three points: that
// is the gauge. A point without observations stays where it is.
struct BundleProblem {
  std::vector<IdealCamera> cameras;
  std::vector<BundlePose> poses;
  std::vector<BundlePoint> points;
  std::vector<BundleObservation> observations;
};

enum class BundleSolver {
  // Our own Levenberg-Marquardt on the dense Schur complement: the fastest up to some 60 free poses. One thread.
  kLocal,
  // The same on the sparse Schur complement, factored by CHOLMOD: for maps of thousands of poses. One thread.
  kSparse,
  // Ceres, for larger problems: `threads` and `max_seconds` apply.
  kDenseSchur,
  kSparseSchur,
  kIterativeSchur,
};

struct BundleOptions {
  BundleSolver solver = BundleSolver::kLocal;
  // Squared residuals, in sigmas, beyond which an observation is an outlier; the Huber kernel of the first phase bends
  // at their roots.
  double monocular_chi2 = kMonocularChi2;
  double stereo_chi2 = kStereoChi2;
  // The measurements may be better than their sigmas say: what is off by kBeyondDoubt times the root of its threshold,
  // in the noise that the first phase's residuals show (MeasuredNoise, at least this), is an outlier as well. 1: by the
  // given sigmas alone.
  double least_noise = 1.0;
  int iterations = 5;  // steps of the first phase
  // Steps of a second phase without the observations that the first left as outliers. 0: none.
  int iterations_without_outliers = 0;
  // Its kernel bends at this share of the roots of the thresholds, those that the noise gives; infinity: no kernel.
  double narrow_share = kNarrowShare;
  double cost_tolerance = 1e-6;  // a phase ends when a step lowers the cost by less than this, relatively
  int threads = 1;               // Ceres only
  double max_seconds = 0.0;      // Ceres only, per phase; 0: no limit
  // The others read no clock and ask after every step instead; the best state so far is returned. None: no limit.
  std::function<bool()> out_of_time = {};
  std::stop_token stop;  // looked at after every step; the best state so far is returned

  Status Check() const;
};

struct BundleResult {
  std::vector<Rigid3d> poses;           // camera_from_map, index by index; fixed ones bit-identical
  std::vector<Eigen::Vector3d> points;  // point_in_map
  std::vector<std::uint8_t> outliers;   // per observation: beyond its threshold, or behind the camera, at the end
  // Half the sum of the kernel of the squared residuals in sigmas: before, and after the last phase, each over the
  // observations and with the kernel of the first and last phase. With two phases they do not compare.
  double initial_cost = 0.0;
  double final_cost = 0.0;
  int iterations = 0;      // steps tried, over all phases
  bool converged = false;  // the last phase ended by its tolerance
  bool cancelled = false;  // by options.stop
};

// Whether a point or position can be part of a problem: finite, and not beyond all bounds (1e8).
bool IsWithinBounds(const Eigen::Vector3d& position);

// Puts poses and points where a solution has them, one of this problem or of one that only has more points; what is
// beyond all bounds there stays where it was.
void StartFrom(const BundleResult& solution, BundleProblem& problem);

// Adjusts every pose and point that is not fixed. Fails with kInvalidArgument for a non-finite number, an index out
// of range, a bad option or a missing gauge.
Result<BundleResult> SolveBundle(const BundleProblem& problem, const BundleOptions& options);

}  // namespace pangaea
