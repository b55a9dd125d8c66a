#include "server/fusion/seam_residual.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include "common/geometry/reprojection.h"
#include "server/fusion/seam_adjustment.h"

namespace pangaea {
namespace {

// The Huber cost of a squared residual, as the bundle adjustment's first phase minimises it: it bends at the
// threshold's root, so that a seam that was tied wrongly shows.
double HuberCost(double squared, double threshold) {
  return squared <= threshold ? 0.5 * squared : std::sqrt(threshold * squared) - 0.5 * threshold;
}

void Add(const BundleProblem& problem, const BundleObservation& observation, SeamResidual& residual) {
  const BundlePose& pose = problem.poses[static_cast<std::size_t>(observation.pose)];
  const BundlePoint& point = problem.points[static_cast<std::size_t>(observation.point)];
  const IdealCamera& camera = problem.cameras[static_cast<std::size_t>(pose.camera)];
  const Eigen::Vector3d point_in_camera = pose.camera_from_map * point.point_in_map;
  const double squared =
      (observation.inverse_sigma * ReprojectionError(camera, point_in_camera, observation.measurement)).squaredNorm();
  const double threshold = IsStereo(observation.measurement) ? kStereoChi2 : kMonocularChi2;
  ++residual.observations;
  residual.cost += HuberCost(squared, threshold);
  if (squared > threshold || point_in_camera.z() <= kMinDepth) return;
  ++residual.inliers;
  residual.inlier_cost += squared;
}

}  // namespace

double SeamResidual::mean_cost() const { return observations == 0 ? 0.0 : cost / static_cast<double>(observations); }

double SeamResidual::inlier_share() const {
  return observations == 0 ? 0.0 : static_cast<double>(inliers) / static_cast<double>(observations);
}

double SeamResidual::rms_inliers() const {
  return inliers == 0 ? 0.0 : std::sqrt(inlier_cost / static_cast<double>(inliers));
}

SeamResidual& SeamResidual::operator+=(const SeamResidual& other) {
  observations += other.observations;
  inliers += other.inliers;
  cost += other.cost;
  inlier_cost += other.inlier_cost;
  return *this;
}

SeamResidual MeasureResidual(const WindowBundle& bundle, const std::vector<LandmarkId>& landmarks) {
  // Both ascend.
  std::vector<std::uint8_t> counts(bundle.landmarks.size());
  auto next = landmarks.begin();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    while (next != landmarks.end() && *next < bundle.landmarks[i]) ++next;
    counts[i] = next != landmarks.end() && *next == bundle.landmarks[i] ? 1 : 0;
  }
  SeamResidual residual;
  for (const BundleObservation& observation : bundle.problem.observations) {
    if (counts[static_cast<std::size_t>(observation.point)] != 0) Add(bundle.problem, observation, residual);
  }
  return residual;
}

SeamResidual MeasureResidual(const Atlas& atlas, const std::vector<KeyframeId>& keyframes,
                             const MeasurementNoiseOptions& noise) {
  const BundleWindow window{.free = keyframes, .fixed = {}, .landmarks = TyingLandmarks(atlas, keyframes)};
  const WindowBundle bundle = BuildWindowBundle(atlas, window, noise);
  return MeasureResidual(bundle, bundle.landmarks);
}

}  // namespace pangaea
