#include "agent/tracking/pose_observability.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "common/base/median.h"

namespace pangaea {
namespace {

double MedianDepth(const LocatedFrame& located, const LocalMap& local_map) {
  std::vector<double> depths;
  for (const LandmarkMatch& match : located.matches) {
    const LocalLandmark& landmark = local_map.landmarks[static_cast<std::size_t>(match.landmark)];
    depths.push_back((located.pose.camera_from_map * landmark.point_in_map).z());
  }
  return Median(std::move(depths));
}

}  // namespace

bool PositionIsObservable(const LocatedFrame& located, const LocalMap& local_map, bool metric,
                          const ObservabilityOptions& options) {
  const double median_depth = metric ? 0.0 : MedianDepth(located, local_map);
  return PositionIsObservable(located.pose, median_depth, metric, options);
}

}  // namespace pangaea
