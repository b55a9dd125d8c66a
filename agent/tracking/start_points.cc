#include "agent/tracking/start_points.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "common/base/check.h"
#include "common/base/median.h"
#include "common/estimation/bundle_adjustment.h"
#include "common/estimation/pose_refinement.h"

namespace pangaea {
namespace {

constexpr double kMinAgreement = 0.5;
// Steps with all observations, and then with a narrower kernel and without outliers: from a good start few are needed.
constexpr int kWideSteps = 10;
constexpr int kNarrowSteps = 10;

Eigen::Vector3d MonocularMeasurement(const Eigen::Vector2d& pixel) { return {pixel.x(), pixel.y(), -1.0}; }

BundleProblem MakeProblem(const IdealCamera& camera, const StartPoints& points, std::span<const StartView> views) {
  BundleProblem problem;
  problem.cameras.push_back(camera);
  problem.poses.push_back({Rigid3d(), 0, true});
  std::map<std::uint32_t, int> index;
  for (const auto& [keypoint, point] : points) {
    index[keypoint] = static_cast<int>(problem.points.size());
    problem.observations.push_back({0, index[keypoint], MonocularMeasurement(point.first_pixel), 1.0 / point.sigma});
    problem.points.push_back({point.point_in_first, false});
  }
  for (const StartView& view : views) {
    const int pose = static_cast<int>(problem.poses.size());
    problem.poses.push_back({view.frame_from_first, 0, false});
    for (const InitialTrack& track : view.tracks) {
      const auto found = index.find(track.keypoint);
      if (found == index.end()) continue;
      problem.observations.push_back(
          {pose, found->second, MonocularMeasurement(track.pixel.cast<double>()), 1.0 / track.sigma});
    }
  }
  return problem;
}

void ScaleToDepth(double median_depth, StartPoints& points, std::span<StartView> views) {
  std::vector<double> depths;
  for (const auto& [keypoint, point] : points) depths.push_back(point.point_in_first.z());
  const double scale = median_depth / Median(std::move(depths));
  for (auto& [keypoint, point] : points) point.point_in_first *= scale;
  for (StartView& view : views) {
    view.frame_from_first = Rigid3d(view.frame_from_first.rotation(), scale * view.frame_from_first.translation());
  }
}

}  // namespace

std::optional<Rigid3d> LocateOnPoints(const IdealCamera& camera, const StartPoints& points,
                                      std::span<const InitialTrack> tracks, const Rigid3d& guess_frame_from_first,
                                      int min_inliers) {
  std::vector<PoseObservation> observations;
  for (const InitialTrack& track : tracks) {
    const auto found = points.find(track.keypoint);
    if (found == points.end()) continue;
    observations.push_back(
        {found->second.point_in_first, MonocularMeasurement(track.pixel.cast<double>()), 1.0 / track.sigma});
  }
  std::vector<std::uint8_t> inliers(observations.size());
  PoseRefinementOptions options;
  options.min_inliers = min_inliers;
  const auto pose = RefinePose(camera, guess_frame_from_first, observations, options, inliers);
  if (!pose || pose->inliers < kMinAgreement * static_cast<double>(observations.size())) return std::nullopt;
  return pose->camera_from_map;
}

void AdjustStart(const IdealCamera& camera, double median_depth, StartPoints& points, std::span<StartView> views) {
  const BundleProblem problem = MakeProblem(camera, points, views);
  BundleOptions options;
  options.iterations = kWideSteps;
  options.iterations_without_outliers = kNarrowSteps;
  const auto adjusted = SolveBundle(problem, options);
  PANGAEA_CHECK(adjusted.has_value());
  const int last_pose = static_cast<int>(views.size());
  std::vector<int> seen(points.size(), 0);
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const BundleObservation& observation = problem.observations[i];
    const bool needed = observation.pose == 0 || observation.pose == last_pose;
    if (needed && adjusted->outliers[i] == 0) ++seen[static_cast<std::size_t>(observation.point)];
  }
  std::size_t next = 0;
  for (auto point = points.begin(); point != points.end(); ++next) {
    point->second.point_in_first = adjusted->points[next];
    point = seen[next] < 2 ? points.erase(point) : std::next(point);
  }
  for (std::size_t i = 0; i < views.size(); ++i) views[i].frame_from_first = adjusted->poses[i + 1];
  if (!points.empty()) ScaleToDepth(median_depth, points, views);
}

}  // namespace pangaea
