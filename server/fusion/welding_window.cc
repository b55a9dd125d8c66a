#include "server/fusion/welding_window.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "common/map/covisibility.h"

namespace pangaea {
namespace {

// One side of a window while it grows over the covisibility graph.
class GrowingSide {
 public:
  GrowingSide(const Atlas& atlas, KeyframeId seed, std::size_t max_keyframes, std::set<KeyframeId>& taken)
      : atlas_(atlas), max_keyframes_(max_keyframes), taken_(taken) {
    Take(seed);
  }

  // Takes the neighbours of the next keyframe, those that share most with it first; false when there is nothing more.
  bool Grow() {
    if (next_ == keyframes_.size() || keyframes_.size() >= max_keyframes_) return false;
    for (const Covisibility& edge : CovisibleKeyframes(atlas_, keyframes_[next_++])) {
      if (keyframes_.size() < max_keyframes_) Take(edge.keyframe);
    }
    return true;
  }
  const std::vector<KeyframeId>& keyframes() const { return keyframes_; }

 private:
  void Take(KeyframeId id) {
    if (taken_.insert(id).second) keyframes_.push_back(id);
  }

  const Atlas& atlas_;
  std::size_t max_keyframes_;
  std::set<KeyframeId>& taken_;  // by either side
  std::vector<KeyframeId> keyframes_;
  std::size_t next_ = 0;
};

// Those outside of the window that see most of the kept side's landmarks.
std::vector<KeyframeId> OuterRing(const Atlas& atlas, const WeldingWindow& window, std::size_t count) {
  std::set<KeyframeId> inside(window.kept.begin(), window.kept.end());
  inside.insert(window.moved.begin(), window.moved.end());
  std::map<KeyframeId, int> seen;
  for (const LandmarkId id : LandmarksSeenBy(atlas, window.kept)) {
    for (const Observation& observation : atlas.FindLandmark(id)->observations) {
      if (!inside.contains(observation.keyframe)) ++seen[observation.keyframe];
    }
  }
  std::vector<std::pair<int, KeyframeId>> ranked;
  for (const auto& [keyframe, number] : seen) ranked.emplace_back(-number, keyframe);
  std::sort(ranked.begin(), ranked.end());
  std::vector<KeyframeId> ring;
  for (std::size_t i = 0; i < std::min(count, ranked.size()); ++i) ring.push_back(ranked[i].second);
  return ring;
}

// The keyframe of the kept side that is farthest from the fixed ones; none where all are fixed.
KeyframeId FarthestFromFixed(const Atlas& atlas, const WeldingWindow& window) {
  const auto center = [&](KeyframeId id) { return atlas.FindKeyframe(id)->camera_from_map.Inverse().translation(); };
  KeyframeId farthest;
  double largest = -1.0;
  for (const KeyframeId id : window.kept) {
    double nearest = std::numeric_limits<double>::max();
    for (const KeyframeId fixed : window.fixed) {
      nearest = fixed == id ? -1.0 : std::min(nearest, (center(id) - center(fixed)).norm());
      if (fixed == id) break;
    }
    if (nearest > largest) {
      largest = nearest;
      farthest = id;
    }
  }
  return farthest;
}

void FixGauge(const Atlas& atlas, const Seam& seam, WeldingWindow& window) {
  const auto contains = [](const std::vector<KeyframeId>& list, KeyframeId id) {
    return std::find(list.begin(), list.end(), id) != list.end();
  };
  const KeyframeId root = atlas.FindMap(seam.kept_map)->root;
  if (contains(window.kept, root)) window.fixed.push_back(root);
  if (window.fixed.empty()) window.fixed.push_back(window.kept.back());
  // One pose leaves the scale free. The farther apart the two, the less their own errors bend it.
  if (!seam.scale_free || window.fixed.size() > 1) return;
  const KeyframeId second = FarthestFromFixed(atlas, window);
  if (second.valid()) window.fixed.push_back(second);
}

}  // namespace

WeldingWindow GrowWeldingWindow(const Atlas& atlas, const Seam& seam, const WeldingWindowOptions& options) {
  std::set<KeyframeId> taken;
  GrowingSide kept(atlas, seam.kept, options.keyframes, taken);
  GrowingSide moved(atlas, seam.moved, options.keyframes, taken);
  // In turns: where the two sides of a loop are connected already, each keyframe goes to the nearer end.
  for (bool growing = true; growing;) {
    const bool kept_grew = kept.Grow();
    growing = moved.Grow() || kept_grew;
  }
  WeldingWindow window{.kept = kept.keyframes(), .moved = moved.keyframes(), .fixed = {}};
  window.fixed = OuterRing(atlas, window, options.fixed_keyframes);
  FixGauge(atlas, seam, window);
  return window;
}

}  // namespace pangaea
