#include "server/fusion/redundancy.h"

#include <algorithm>
#include <functional>
#include <queue>
#include <utility>

#include "common/base/check.h"
#include "common/base/range_check.h"
#include "common/map/map_edit.h"
#include "common/mapping/keyframe_redundancy.h"

namespace pangaea {
namespace {

std::size_t BytesOf(const Keyframe& keyframe) {
  std::size_t bytes = sizeof(Keyframe) + sizeof(KeyframeData);
  bytes += keyframe.data->features.keypoints.size() * (sizeof(Keypoint) + sizeof(Descriptor) + sizeof(LandmarkId));
  bytes += keyframe.covisible.size() * sizeof(Covisibility) + keyframe.children.size() * sizeof(KeyframeId);
  return bytes + (keyframe.frames ? keyframe.frames->size() * sizeof(FramePose) : 0);
}

std::size_t BytesOf(const Landmark& landmark) {
  return sizeof(Landmark) + landmark.observations.size() * sizeof(Observation);
}

class Culling {
 public:
  Culling(const Atlas& atlas, const std::set<KeyframeId>& in_use, const RedundancyOptions& options,
          std::stop_token stop)
      : atlas_(atlas), in_use_(in_use), options_(options), stop_(std::move(stop)), bytes_(EstimateBytes(atlas)) {
    for (const LoopEdge& edge : atlas.loop_edges()) loop_ends_.insert({edge.from, edge.to});
  }

  std::vector<MapEdit> Run() {
    CullKeyframes([](const Keyframe&) { return true; });
    if (options_.max_bytes > 0) CullLandmarks();
    return std::move(edits_);
  }
  std::vector<MapEdit> RunOn(MapId map) {
    CullKeyframes([map](const Keyframe& keyframe) { return keyframe.map == map; });
    return std::move(edits_);
  }

 private:
  bool IsDone() const { return stop_.stop_requested() || (options_.max_bytes > 0 && bytes_ <= options_.max_bytes); }

  bool MayGo(const Keyframe& keyframe) const {
    return keyframe.parent.valid() && !in_use_.contains(keyframe.id) && !loop_ends_.contains(keyframe.id);
  }

  double ShareOf(const Keyframe& keyframe) const {
    return RedundantShare(atlas_, keyframe,
                          {.other_observers = options_.other_observers, .coarser_octaves = options_.coarser_octaves});
  }

  // With each keyframe that goes, the others get less redundant and never more. So one whose share is still what it was
  // when it was put into the queue is the most redundant of all.
  void CullKeyframes(const std::function<bool(const Keyframe&)>& concerns) {
    std::priority_queue<std::pair<double, KeyframeId>> queue;
    const auto enqueue = [&](double share, KeyframeId id) {
      if (share >= options_.redundant_share) queue.emplace(share, id);
    };
    atlas_.ForEachKeyframe([&](const Keyframe& keyframe) {
      if (concerns(keyframe) && MayGo(keyframe)) enqueue(ShareOf(keyframe), keyframe.id);
    });
    while (!queue.empty() && !IsDone()) {
      const auto [share, id] = queue.top();
      queue.pop();
      const Keyframe& keyframe = *atlas_.FindKeyframe(id);
      const double now = ShareOf(keyframe);
      if (now < share) {
        enqueue(now, id);
      } else {
        Do(RemoveKeyframe{id}, BytesOf(keyframe));
      }
    }
  }

  void CullLandmarks() {
    std::vector<std::pair<LandmarkId, std::size_t>> weak;
    atlas_.ForEachLandmark([&](const Landmark& landmark) {
      if (landmark.observations.size() >= options_.min_landmark_observers) return;
      for (const Observation& observation : landmark.observations) {
        if (in_use_.contains(observation.keyframe)) return;
      }
      weak.emplace_back(landmark.id, BytesOf(landmark));
    });
    for (const auto& [id, bytes] : weak) {
      if (IsDone()) return;
      Do(RemoveLandmark{id}, bytes);
    }
  }

  void Do(MapEdit edit, std::size_t freed) {
    const Status status = Apply(edit, atlas_);
    PANGAEA_CHECK(status.has_value());
    edits_.push_back(std::move(edit));
    bytes_ -= std::min(freed, bytes_);
  }

  Atlas atlas_;  // as it becomes
  const std::set<KeyframeId>& in_use_;
  const RedundancyOptions& options_;
  std::stop_token stop_;
  std::size_t bytes_;
  std::set<KeyframeId> loop_ends_;
  std::vector<MapEdit> edits_;
};

}  // namespace

Status RedundancyOptions::Check() const {
  RangeCheck check("redundancy");
  check.In("redundant_share", redundant_share, 0.1, 1)
      .In("other_observers", other_observers, 1, 1000)
      .In("coarser_octaves", coarser_octaves, 0, kOctaves)
      .In("max_bytes", max_bytes, 0, RangeCheck::kUnlimited)
      .In("min_landmark_observers", min_landmark_observers, 1, 1000);
  return check.status();
}

std::size_t EstimateBytes(const Atlas& atlas) {
  std::size_t bytes = 0;
  atlas.ForEachKeyframe([&](const Keyframe& keyframe) { bytes += BytesOf(keyframe); });
  atlas.ForEachLandmark([&](const Landmark& landmark) { bytes += BytesOf(landmark); });
  return bytes;
}

std::vector<MapEdit> PlanCulling(const Atlas& atlas, const std::set<KeyframeId>& in_use,
                                 const RedundancyOptions& options, std::stop_token stop) {
  return Culling(atlas, in_use, options, std::move(stop)).Run();
}

std::vector<MapEdit> PlanKeyframeCulling(const Atlas& atlas, MapId map, const std::set<KeyframeId>& in_use,
                                         const RedundancyOptions& options, std::stop_token stop) {
  RedundancyOptions unlimited = options;
  unlimited.max_bytes = 0;
  return Culling(atlas, in_use, unlimited, std::move(stop)).RunOn(map);
}

}  // namespace pangaea
