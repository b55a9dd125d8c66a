#include "server/fusion/landmark_thinning.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "common/base/range_check.h"
#include "common/map/edits/remove_landmark.h"
#include "common/map/spanning_tree.h"

namespace pangaea {
namespace {

// How many landmarks a keyframe sees, in all and in each cell of its image.
class SeenLandmarks {
 public:
  SeenLandmarks(const Keyframe& keyframe, int cell)
      : keypoints_(keyframe.data->features.keypoints),
        cell_(static_cast<float>(cell)),
        columns_(keyframe.data->camera.width / cell + 1),
        in_cell_(static_cast<std::size_t>(columns_ * (keyframe.data->camera.height / cell + 1)), 0) {
    for (std::size_t i = 0; i < keyframe.landmarks.size(); ++i) {
      if (!keyframe.landmarks[i].valid()) continue;
      ++all_;
      ++in_cell_[CellOf(i)];
    }
  }

  bool CanSpare(std::uint32_t keypoint, const ThinningOptions& options) const {
    return all_ > options.kept && in_cell_[CellOf(keypoint)] > options.kept_in_cell;
  }
  void Lose(std::uint32_t keypoint) {
    --all_;
    --in_cell_[CellOf(keypoint)];
  }

 private:
  // Ideal keypoints may lie a little outside of the image.
  std::size_t CellOf(std::size_t keypoint) const {
    const auto column = std::clamp(static_cast<int>(keypoints_[keypoint].u / cell_), 0, columns_ - 1);
    const int rows = static_cast<int>(in_cell_.size()) / columns_;
    const auto row = std::clamp(static_cast<int>(keypoints_[keypoint].v / cell_), 0, rows - 1);
    return static_cast<std::size_t>(row * columns_ + column);
  }

  const std::vector<Keypoint>& keypoints_;
  float cell_;
  int columns_;
  std::size_t all_ = 0;
  std::vector<std::size_t> in_cell_;
};

struct WeakLandmark {
  std::size_t observers;
  double cosine;  // of the widest angle from which two keyframes see it; 1 where one does
  LandmarkId id;

  // From the weakest on.
  bool operator<(const WeakLandmark& other) const {
    if (observers != other.observers) return observers < other.observers;
    return cosine != other.cosine ? cosine > other.cosine : id < other.id;
  }
};

double SmallestCosine(const Atlas& atlas, const Landmark& landmark) {
  std::vector<Eigen::Vector3d> rays;
  for (const Observation& observation : landmark.observations) {
    const Rigid3d& pose = atlas.FindKeyframe(observation.keyframe)->camera_from_map;
    rays.push_back((landmark.point_in_map - pose.Inverse().translation()).normalized());
  }
  double cosine = 1.0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    for (std::size_t k = i + 1; k < rays.size(); ++k) cosine = std::min(cosine, rays[i].dot(rays[k]));
  }
  return cosine;
}

bool MayGo(const Landmark& landmark, const std::set<KeyframeId>& in_use) {
  const SessionId session = landmark.observations.front().keyframe.session;
  return std::ranges::all_of(landmark.observations, [&](const Observation& observation) {
    return observation.keyframe.session == session && !in_use.contains(observation.keyframe);
  });
}

std::vector<WeakLandmark> WeakestFirst(const Atlas& atlas, MapId map, const std::set<KeyframeId>& in_use,
                                       std::size_t max_observers) {
  std::vector<WeakLandmark> weak;
  atlas.ForEachLandmark([&](const Landmark& landmark) {
    const std::size_t observers = landmark.observations.size();
    if (observers > max_observers || atlas.MapOf(landmark) != map || !MayGo(landmark, in_use)) return;
    weak.push_back({observers, SmallestCosine(atlas, landmark), landmark.id});
  });
  std::ranges::sort(weak, std::less());
  return weak;
}

}  // namespace

Status ThinningOptions::Check() const {
  RangeCheck check("thinning");
  check.In("kept", kept, 20, 1e6).In("kept_in_cell", kept_in_cell, 0, 1e6).In("cell", cell, 8, 10000);
  check.In("max_observers", max_observers, 0, 1000);
  return check.status();
}

std::vector<MapEdit> PlanThinning(const Atlas& atlas, MapId map, const std::set<KeyframeId>& in_use,
                                  const ThinningOptions& options, std::stop_token stop) {
  std::unordered_map<KeyframeId, SeenLandmarks> seen;
  for (const KeyframeId id : ParentsFirst(atlas, map)) {
    seen.emplace(id, SeenLandmarks(*atlas.FindKeyframe(id), options.cell));
  }
  std::vector<MapEdit> edits;
  for (const WeakLandmark& weak : WeakestFirst(atlas, map, in_use, options.max_observers)) {
    if (stop.stop_requested()) break;
    const std::vector<Observation>& observations = atlas.FindLandmark(weak.id)->observations;
    const bool spared = std::ranges::all_of(
        observations, [&](const Observation& o) { return seen.at(o.keyframe).CanSpare(o.keypoint, options); });
    if (!spared) continue;
    for (const Observation& o : observations) seen.at(o.keyframe).Lose(o.keypoint);
    edits.emplace_back(RemoveLandmark{weak.id});
  }
  return edits;
}

}  // namespace pangaea
