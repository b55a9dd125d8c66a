#include "server/fusion/drift_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/base/median.h"

namespace pangaea {
namespace {

// Shortest ways over verified edges (Dijkstra 1959).
class WayFinder {
 public:
  WayFinder(const Atlas& atlas, unsigned min_shared_landmarks)
      : atlas_(atlas), min_shared_landmarks_(min_shared_landmarks) {
    for (const LoopEdge& edge : atlas.loop_edges()) {
      loops_[edge.from].push_back(edge.to);
      loops_[edge.to].push_back(edge.from);
    }
  }

  // Infinite where there is none.
  double Length(KeyframeId from, KeyframeId to) {
    Reach(from, 0.0);
    while (!open_.empty()) {
      const auto [minus_length, id] = open_.top();
      open_.pop();
      if (id == to) return -minus_length;
      if (-minus_length <= length_.at(id)) Leave(*atlas_.FindKeyframe(id), -minus_length);
    }
    return std::numeric_limits<double>::infinity();
  }

 private:
  void Leave(const Keyframe& keyframe, double length) {
    const Eigen::Vector3d center = keyframe.camera_from_map.Inverse().translation();
    const auto step = [&](KeyframeId next) {
      const Eigen::Vector3d there = atlas_.FindKeyframe(next)->camera_from_map.Inverse().translation();
      Reach(next, length + (there - center).norm());
    };
    if (keyframe.parent.valid()) step(keyframe.parent);
    for (const KeyframeId child : keyframe.children) step(child);
    for (const Covisibility& edge : keyframe.covisible) {
      if (edge.weight >= min_shared_landmarks_) step(edge.keyframe);
    }
    const auto loops = loops_.find(keyframe.id);
    if (loops == loops_.end()) return;
    for (const KeyframeId other : loops->second) step(other);
  }

  void Reach(KeyframeId id, double length) {
    const auto [known, is_new] = length_.try_emplace(id, length);
    if (!is_new && known->second <= length) return;
    known->second = length;
    open_.emplace(-length, id);
  }

  const Atlas& atlas_;
  unsigned min_shared_landmarks_;
  std::unordered_map<KeyframeId, std::vector<KeyframeId>> loops_;
  std::unordered_map<KeyframeId, double> length_;
  std::priority_queue<std::pair<double, KeyframeId>> open_;  // minus length: the nearest first
};

double MedianDepth(const Atlas& atlas, const Keyframe& keyframe) {
  std::vector<double> distances;
  for (const LandmarkId id : keyframe.landmarks) {
    if (id.valid()) distances.push_back((keyframe.camera_from_map * atlas.FindLandmark(id)->point_in_map).norm());
  }
  return Median(std::move(distances));
}

}  // namespace

LoopDrift MeasureDrift(const Atlas& atlas, const Seam& loop, const DriftOptions& options) {
  const Keyframe& kept = *atlas.FindKeyframe(loop.kept);
  const Keyframe& moved = *atlas.FindKeyframe(loop.moved);
  LoopDrift drift;
  drift.path = WayFinder(atlas, options.min_shared_landmarks).Length(loop.kept, loop.moved);
  drift.depth = MedianDepth(atlas, kept);

  const Rigid3d map_from_moved = moved.camera_from_map.Inverse();
  const Similarity3d& corrected_from_map = loop.kept_from_moved;
  drift.translation = (corrected_from_map * map_from_moved.translation() - map_from_moved.translation()).norm();
  drift.rotation =
      corrected_from_map.rotation().angularDistance(Eigen::Quaterniond::Identity()) * 180.0 / std::numbers::pi;
  drift.log_scale = std::abs(std::log(corrected_from_map.scale()));

  const double depths = drift.depth > 0.0 ? drift.path / drift.depth : drift.path;
  drift.max_translation = options.min_translation * drift.depth + options.translation_per_path * drift.path;
  drift.max_rotation = options.min_rotation + options.rotation_per_path * depths;
  drift.max_log_scale = options.min_scale + options.scale_per_path * depths;
  return drift;
}

}  // namespace pangaea
