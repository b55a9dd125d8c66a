#include "common/estimation/absolute_pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "common/geometry/perspective_three_point.h"
#include "common/geometry/ransac.h"

namespace pangaea {
namespace {

// Passes of fitting to the inliers and collecting inliers anew.
constexpr int kPolishPasses = 3;

class Estimator {
 public:
  Estimator(const IdealCamera& camera, std::span<const PoseObservation> observations,
            const AbsolutePoseOptions& options)
      : camera_(camera), observations_(observations), options_(options) {
    for (const PoseObservation& observation : observations) {
      bearings_.push_back(camera.Unproject(observation.measurement.head<2>()).normalized());
    }
    options_.refinement.min_inliers = std::max(options_.refinement.min_inliers, 4);
  }

  void Solve(std::span<const std::size_t> sample, std::vector<Rigid3d>& poses) const {
    std::array<Eigen::Vector3d, 3> bearings;
    std::array<Eigen::Vector3d, 3> points;
    for (std::size_t i = 0; i < 3; ++i) {
      bearings[i] = bearings_[sample[i]];
      points[i] = observations_[sample[i]].point_in_map;
    }
    const ThreePointPoses solutions = SolvePerspectiveThreePoint(bearings, points);
    poses.insert(poses.end(), solutions.camera_from_map.begin(), solutions.camera_from_map.begin() + solutions.count);
  }

  // MSAC (Torr and Zisserman 2000): squared residuals cut off at their thresholds.
  RansacScore Score(const Rigid3d& camera_from_map, std::span<std::uint8_t> inliers) const {
    const Eigen::Matrix3d rotation = camera_from_map.rotation().toRotationMatrix();
    RansacScore score{0.0, 0};
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      const PoseObservation& observation = observations_[i];
      const Eigen::Vector3d point_in_camera = rotation * observation.point_in_map + camera_from_map.translation();
      Eigen::Vector3d measurement = observation.measurement;
      if (!camera_.is_stereo()) measurement.z() = -1.0;
      const double limit = IsStereo(measurement) ? options_.refinement.stereo_chi2 : options_.refinement.monocular_chi2;
      const double squared = observation.inverse_sigma * observation.inverse_sigma *
                             ReprojectionError(camera_, point_in_camera, measurement).squaredNorm();
      const bool is_inlier = point_in_camera.z() > kMinDepth && squared <= limit;  // false for NaN
      inliers[i] = is_inlier ? 1 : 0;
      score.inliers += inliers[i];
      score.cost += is_inlier ? squared / limit : 1.0;
    }
    return score;
  }

  std::optional<Rigid3d> Improve(const Rigid3d& camera_from_map, std::span<const std::uint8_t> inliers) const {
    PoseRefinementOptions squares = options_.refinement;  // as Score judges
    squares.narrow_share = std::numeric_limits<double>::infinity();
    const std::optional<RefinedPose> refined = Fit(camera_from_map, inliers, squares);
    if (!refined) return std::nullopt;
    return refined->camera_from_map;
  }

  // The pose of the flagged observations.
  std::optional<RefinedPose> Fit(const Rigid3d& camera_from_map, std::span<const std::uint8_t> inliers,
                                 const PoseRefinementOptions& refinement) const {
    std::vector<PoseObservation> kept;
    for (std::size_t i = 0; i < inliers.size(); ++i) {
      if (inliers[i] != 0) kept.push_back(observations_[i]);
    }
    std::vector<std::uint8_t> flags(kept.size());
    return RefinePose(camera_, camera_from_map, kept, refinement, flags);
  }

 private:
  const IdealCamera& camera_;
  std::span<const PoseObservation> observations_;
  AbsolutePoseOptions options_;
  std::vector<Eigen::Vector3d> bearings_;
};

}  // namespace

Status AbsolutePoseOptions::Check() const {
  if (const Status status = refinement.Check(); !status) return status;
  if (!(confidence > 0.0) || !(confidence < 1.0)) {
    return Fail(ErrorCode::kInvalidArgument, "absolute pose: confidence must be in (0, 1)");
  }
  if (max_iterations < 1 || min_inliers < 4) {
    return Fail(ErrorCode::kInvalidArgument, "absolute pose: max_iterations must be >= 1 and min_inliers >= 4");
  }
  return {};
}

std::optional<AbsolutePose> EstimateAbsolutePose(const IdealCamera& camera,
                                                 std::span<const PoseObservation> observations,
                                                 const AbsolutePoseOptions& options, std::uint64_t seed) {
  const Estimator estimator(camera, observations, options);
  RansacOptions ransac{.sample_size = 3, .max_iterations = options.max_iterations, .confidence = options.confidence};
  auto best = Ransac<Rigid3d>(
      observations.size(), ransac, seed,
      [&](std::span<const std::size_t> sample, std::vector<Rigid3d>& poses) { estimator.Solve(sample, poses); },
      [&](const Rigid3d& pose, std::span<std::uint8_t> inliers) { return estimator.Score(pose, inliers); },
      [&](const Rigid3d& pose, std::span<const std::uint8_t> inliers) { return estimator.Improve(pose, inliers); });
  if (!best) return std::nullopt;

  AbsolutePose result;
  result.inliers = std::move(best->inliers);
  result.iterations = best->iterations;
  result.pose.camera_from_map = best->model;
  for (int pass = 0; pass < kPolishPasses; ++pass) {
    const std::optional<RefinedPose> refined =
        estimator.Fit(result.pose.camera_from_map, result.inliers, options.refinement);
    if (!refined) return std::nullopt;
    result.pose = *refined;
    std::vector<std::uint8_t> previous = result.inliers;
    result.pose.inliers = static_cast<int>(estimator.Score(result.pose.camera_from_map, result.inliers).inliers);
    if (result.inliers == previous) break;
  }
  if (result.pose.inliers < options.min_inliers) return std::nullopt;
  return result;
}

}  // namespace pangaea
