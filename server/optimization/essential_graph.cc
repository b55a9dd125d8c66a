#include "server/optimization/essential_graph.h"

#include <algorithm>

#include "common/map/spanning_tree.h"

namespace pangaea {
namespace {

std::uint32_t SharedLandmarks(const Keyframe& a, KeyframeId b) {
  const auto found = std::ranges::lower_bound(a.covisible, b, {}, &Covisibility::keyframe);
  return found != a.covisible.end() && found->keyframe == b ? found->weight : 0;
}

class EdgeCollector {
 public:
  EdgeCollector(const Atlas& before, const Atlas& after, MapId map) : before_(before), after_(after), map_(map) {}

  void AddTreeEdge(const Keyframe& keyframe) {
    if (const Keyframe* parent = after_.FindKeyframe(keyframe.parent)) Add(*parent, keyframe);
  }

  // Each once, from its end of the lower id; those of the tree are there already.
  void AddCovisibilityEdges(const Keyframe& keyframe, std::uint32_t min_shared_landmarks) {
    for (const Covisibility& covisible : Measured(keyframe).covisible) {
      if (covisible.weight < min_shared_landmarks || covisible.keyframe < keyframe.id) continue;
      const Keyframe* other = after_.FindKeyframe(covisible.keyframe);
      if (other == nullptr || other->map != map_ ||
          (InBefore(other->id) == nullptr) != (InBefore(keyframe.id) == nullptr))
        continue;
      if (other->parent != keyframe.id && keyframe.parent != other->id) Add(keyframe, *other);
    }
  }

  void AddLoopEdges() {
    for (const LoopEdge& loop : after_.loop_edges()) {
      const Keyframe& from = *after_.FindKeyframe(loop.from);
      const Keyframe& to = *after_.FindKeyframe(loop.to);
      if (from.map != map_) continue;
      if (IsKnownBefore(loop)) {
        Add(from, to);
      } else {
        edges_.push_back({from.id, to.id, loop.to_from_from, SharedLandmarks(from, to.id)});
      }
    }
  }

  std::vector<PoseGraphEdge> Take() { return std::move(edges_); }

 private:
  const Keyframe* InBefore(KeyframeId id) const {
    const Keyframe* keyframe = before_.FindKeyframe(id);
    return keyframe != nullptr && keyframe->map == map_ ? keyframe : nullptr;
  }
  const Keyframe& Measured(const Keyframe& keyframe) const {
    const Keyframe* before = InBefore(keyframe.id);
    return before == nullptr ? keyframe : *before;
  }
  bool IsKnownBefore(const LoopEdge& loop) const {
    return std::ranges::any_of(before_.loop_edges(), [&](const LoopEdge& known) {
      return known.from == loop.from && known.to == loop.to && InBefore(known.from) && InBefore(known.to);
    });
  }
  void Add(const Keyframe& from, const Keyframe& to) {
    const bool both_before = InBefore(from.id) != nullptr && InBefore(to.id) != nullptr;
    const Keyframe& a = both_before ? Measured(from) : from;
    const Keyframe& b = both_before ? Measured(to) : to;
    edges_.push_back(
        {from.id, to.id, Similarity3d(b.camera_from_map * a.camera_from_map.Inverse()), SharedLandmarks(a, b.id)});
  }

  const Atlas& before_;
  const Atlas& after_;
  const MapId map_;
  std::vector<PoseGraphEdge> edges_;
};

}  // namespace

std::vector<PoseGraphEdge> EssentialGraph(const Atlas& before_seam, const Atlas& after_seam, MapId map,
                                          std::uint32_t min_shared_landmarks) {
  EdgeCollector collector(before_seam, after_seam, map);
  for (const KeyframeId id : ParentsFirst(after_seam, map)) {
    const Keyframe& keyframe = *after_seam.FindKeyframe(id);
    collector.AddTreeEdge(keyframe);
    collector.AddCovisibilityEdges(keyframe, min_shared_landmarks);
  }
  collector.AddLoopEdges();
  return collector.Take();
}

}  // namespace pangaea
