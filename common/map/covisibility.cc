#include "common/map/covisibility.h"

#include <algorithm>
#include <unordered_set>

namespace pangaea {

std::vector<Covisibility> CovisibleKeyframes(const Atlas& atlas, KeyframeId id, std::uint32_t min_weight) {
  std::vector<Covisibility> covisible;
  const Keyframe* keyframe = atlas.FindKeyframe(id);
  if (keyframe == nullptr) return covisible;
  std::copy_if(keyframe->covisible.begin(), keyframe->covisible.end(), std::back_inserter(covisible),
               [&](const Covisibility& edge) { return edge.weight >= min_weight; });
  // They come ascending by id.
  std::stable_sort(covisible.begin(), covisible.end(),
                   [](const Covisibility& a, const Covisibility& b) { return a.weight > b.weight; });
  return covisible;
}

std::vector<KeyframeId> GrowWindow(const Atlas& atlas, KeyframeId seed, std::size_t max_keyframes) {
  std::vector<KeyframeId> window;
  if (atlas.FindKeyframe(seed) == nullptr || max_keyframes == 0) return window;
  window.push_back(seed);
  std::unordered_set<KeyframeId> taken = {seed};
  for (std::size_t next = 0; next < window.size(); ++next) {
    for (const Covisibility& edge : CovisibleKeyframes(atlas, window[next])) {
      if (window.size() == max_keyframes) return window;
      if (taken.insert(edge.keyframe).second) window.push_back(edge.keyframe);
    }
  }
  return window;
}

LandmarkIdSet LandmarkSetOf(const Atlas& atlas, const std::vector<KeyframeId>& keyframes) {
  LandmarkIdSet seen;
  for (const KeyframeId id : keyframes) {
    const Keyframe* keyframe = atlas.FindKeyframe(id);
    if (keyframe == nullptr) continue;
    for (const LandmarkId landmark : keyframe->landmarks) {
      if (landmark.valid()) seen.Insert(landmark);
    }
  }
  return seen;
}

std::vector<LandmarkId> LandmarksSeenBy(const Atlas& atlas, const std::vector<KeyframeId>& keyframes) {
  return LandmarkSetOf(atlas, keyframes).Ascending();
}

}  // namespace pangaea
