#include "agent/tracking/keyframe_decision.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "common/base/median.h"

namespace pangaea {

KeyframeEvidence GatherEvidence(const IdealCamera& camera, const LocatedFrame& located, const LocalMap& local_map,
                                const KeyframeDecisionOptions& options) {
  std::vector<bool> covered(static_cast<std::size_t>(options.grid_columns * options.grid_rows));
  std::vector<double> depths;
  for (const LandmarkMatch& match : located.matches) {
    const int column = std::clamp(static_cast<int>(match.pixel.x() * options.grid_columns / camera.width), 0,
                                  options.grid_columns - 1);
    const int row =
        std::clamp(static_cast<int>(match.pixel.y() * options.grid_rows / camera.height), 0, options.grid_rows - 1);
    covered[static_cast<std::size_t>(row * options.grid_columns + column)] = true;
    depths.push_back((located.pose.camera_from_map * local_map.landmarks[match.landmark].point_in_map).z());
  }
  KeyframeEvidence evidence;
  evidence.inliers = static_cast<int>(located.matches.size());
  evidence.covered_cells = static_cast<int>(std::count(covered.begin(), covered.end(), true));
  evidence.median_depth = Median(std::move(depths));
  return evidence;
}

double ViewDistance(const Rigid3d& camera_from_map, const Rigid3d& keyframe_from_map, double median_depth,
                    const KeyframeDecisionOptions& options) {
  const Rigid3d keyframe_from_camera = keyframe_from_map * camera_from_map.Inverse();
  const double distance = keyframe_from_camera.translation().norm() / (median_depth * options.max_relative_distance);
  const Eigen::Vector3d axis = keyframe_from_camera.rotation() * Eigen::Vector3d::UnitZ();
  const double turn = std::acos(std::clamp(axis.z(), -1.0, 1.0)) * 180.0 / std::numbers::pi;
  return std::max(distance, turn / options.max_turn);
}

bool KeyframeDecision::IsDue(const KeyframeEvidence& evidence, double nearest_view, bool mapping_busy) {
  ++frames_since_;
  best_inliers_ = std::max(best_inliers_, evidence.inliers);
  best_cells_ = std::max(best_cells_, evidence.covered_cells);
  const bool thin = evidence.inliers < options_.min_inlier_ratio * best_inliers_;
  const bool uncovered = evidence.covered_cells < options_.min_coverage_ratio * best_cells_;
  const bool far = nearest_view > 1.0;
  if (!thin && !uncovered && !far) return false;
  const bool urgent = evidence.inliers < options_.urgent_inliers;
  if (nearest_view < options_.known_view && !urgent) return false;
  return urgent || (is_gap_over() && !mapping_busy);
}

void KeyframeDecision::Restart() {
  best_inliers_ = 0;
  best_cells_ = 0;
  frames_since_ = 0;
}

}  // namespace pangaea
