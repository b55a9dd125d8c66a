#include "server/fusion/welding_window.h"

#include <algorithm>
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

void FixGauge(const Atlas& atlas, const Seam& seam, WeldingWindow& window) {
  const KeyframeId root = atlas.FindMap(seam.kept_map)->root;
  const auto is_fixed = [&](KeyframeId id) {
    return std::find(window.fixed.begin(), window.fixed.end(), id) != window.fixed.end();
  };
  const bool root_is_near = std::find(window.kept.begin(), window.kept.end(), root) != window.kept.end();
  if (root_is_near && !is_fixed(root)) window.fixed.push_back(root);
  // One pose leaves the scale free. The farthest keyframes of the side are the ones that the seam needs least.
  const std::size_t needed = seam.scale_free ? 2 : 1;
  for (auto id = window.kept.rbegin(); id != window.kept.rend() && window.fixed.size() < needed; ++id) {
    if (!is_fixed(*id)) window.fixed.push_back(*id);
  }
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
