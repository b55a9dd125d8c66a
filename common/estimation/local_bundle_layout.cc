#include "common/estimation/local_bundle_layout.h"

#include <algorithm>
#include <tuple>

namespace pangaea::local_bundle {
namespace {

void AddCameras(const BundlePhase& phase, const BundleState& state, Layout& layout) {
  const BundleProblem& problem = phase.problem;
  layout.cameras.reserve(problem.poses.size());
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    const BundlePose& pose = problem.poses[i];
    const IdealCamera& ideal = problem.cameras[pose.camera];
    Camera camera{state.camera_from_map[i].rotation().toRotationMatrix(),
                  state.camera_from_map[i].translation(),
                  ideal.focal_x,
                  ideal.focal_y,
                  ideal.center_x,
                  ideal.center_y,
                  ideal.baseline,
                  -1};
    if (!pose.fixed) {
      camera.variable = static_cast<int>(layout.free_poses.size());
      layout.free_poses.push_back(static_cast<int>(i));
    }
    layout.cameras.push_back(camera);
  }
}

// The active observations sorted by point, and by free pose within a point, fixed poses last.
std::vector<int> EliminationOrder(const BundlePhase& phase, const Layout& layout) {
  const std::vector<BundleObservation>& observations = phase.problem.observations;
  std::vector<int> order;
  order.reserve(observations.size());
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (phase.active[i] != 0) order.push_back(static_cast<int>(i));
  }
  const auto key = [&](int index) {
    const BundleObservation& observation = observations[index];
    const auto variable = static_cast<unsigned>(layout.cameras[observation.pose].variable);  // -1 is the largest
    return std::tuple(observation.point, variable, observation.pose, index);
  };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  return order;
}

void AddMeasurement(const BundlePhase& phase, const BundleObservation& observation, Layout& layout) {
  const bool stereo = IsStereo(observation.measurement);
  const int position = static_cast<int>(layout.measurements.size());
  const double disparity = observation.measurement.x() - observation.measurement.z();
  layout.measurements.push_back({observation.measurement.x(), observation.measurement.y(), disparity,
                                 observation.inverse_sigma * observation.inverse_sigma,
                                 stereo ? phase.bends.stereo : phase.bends.monocular, observation.pose, stereo});
  if (layout.tracks.empty() || layout.tracks.back().point != observation.point) {
    const bool fixed = phase.problem.points[observation.point].fixed;
    layout.tracks.push_back({position, position, position, observation.point, fixed});
  }
  Track& track = layout.tracks.back();
  track.end = position + 1;
  if (layout.cameras[observation.pose].variable >= 0) track.free_end = position + 1;
}

}  // namespace

Layout MakeLayout(const BundlePhase& phase, const BundleState& state) {
  Layout layout;
  AddCameras(phase, state, layout);
  const std::vector<int> order = EliminationOrder(phase, layout);
  layout.measurements.reserve(order.size());
  for (const int index : order) AddMeasurement(phase, phase.problem.observations[index], layout);
  return layout;
}

}  // namespace pangaea::local_bundle
