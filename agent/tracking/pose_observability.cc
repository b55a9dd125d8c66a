#include "agent/tracking/pose_observability.h"

#include <algorithm>
#include <vector>

namespace pangaea {
namespace {

double MedianDepth(const LocatedFrame& located, const LocalMap& local_map) {
  std::vector<double> depths;
  for (const LandmarkMatch& match : located.matches) {
    const LocalLandmark& landmark = local_map.landmarks[static_cast<std::size_t>(match.landmark)];
    depths.push_back((located.pose.camera_from_map * landmark.point_in_map).z());
  }
  if (depths.empty()) return 0.0;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle;
}

}  // namespace

bool PositionIsObservable(const LocatedFrame& located, const LocalMap& local_map, bool metric,
                          const ObservabilityOptions& options) {
  const double median_depth = metric ? 0.0 : MedianDepth(located, local_map);
  return PositionIsObservable(located.pose, median_depth, metric, options);
}

}  // namespace pangaea
