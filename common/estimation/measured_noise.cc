#include "common/estimation/measured_noise.h"

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "common/base/median.h"
#include "common/geometry/reprojection.h"

namespace pangaea {
namespace {

// Below it a point's position takes up most of what its residuals could say.
constexpr int kMinObservations = 3;

// What was seen of one point.
struct PointResiduals {
  double squared = 0.0;  // sum, in sigmas
  int components = 0;
  int observations = 0;

  // The variance of a component, were this the median point: an unbiased estimate (the position takes three), divided
  // by what the median of a chi-squared variable is of its mean (Wilson and Hilferty 1931).
  double Variance() const {
    const double freedom = components - 3;
    return squared / (freedom * std::pow(1.0 - 2.0 / (9.0 * freedom), 3));
  }
};

}  // namespace

double MeasuredNoise(const BundleProblem& problem, std::span<const Rigid3d> camera_from_map,
                     std::span<const Eigen::Vector3d> point_in_map) {
  std::vector<PointResiduals> points(problem.points.size());
  for (const BundleObservation& observation : problem.observations) {
    const auto pose = static_cast<std::size_t>(observation.pose);
    const auto point = static_cast<std::size_t>(observation.point);
    const IdealCamera& camera = problem.cameras[static_cast<std::size_t>(problem.poses[pose].camera)];
    const Eigen::Vector3d error =
        ReprojectionError(camera, camera_from_map[pose] * point_in_map[point], observation.measurement);
    points[point].squared += (observation.inverse_sigma * error).squaredNorm();
    points[point].components += IsStereo(observation.measurement) ? 3 : 2;
    ++points[point].observations;
  }
  std::vector<double> variances;
  for (const PointResiduals& point : points) {
    if (point.observations >= kMinObservations) variances.push_back(point.Variance());
  }
  return std::sqrt(Median(std::move(variances), std::numeric_limits<double>::infinity()));
}

double MeasuredNoise(const BundleProblem& problem) {
  std::vector<Rigid3d> poses;
  std::vector<Eigen::Vector3d> points;
  for (const BundlePose& pose : problem.poses) poses.push_back(pose.camera_from_map);
  for (const BundlePoint& point : problem.points) points.push_back(point.point_in_map);
  return MeasuredNoise(problem, poses, points);
}

}  // namespace pangaea
