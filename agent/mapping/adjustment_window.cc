#include <algorithm>
#include <map>
#include <set>

#include "agent/absorption/absorption.h"
#include "agent/mapping/local_bundle_adjustment.h"
#include "agent/mapping/neighbourhood.h"
#include "common/map/covisibility.h"

namespace pangaea {
namespace {

// So many landmarks that do not move hold the gauge; three would do if none of them were an outlier.
constexpr std::size_t kHoldingLandmarks = 30;

bool IsRoot(const Keyframe& keyframe) { return !keyframe.parent.valid(); }

// The observers outside of `free`, those with most of the landmarks first; at most `count`.
std::vector<KeyframeId> ChooseFixed(const Atlas& atlas, const std::vector<LandmarkId>& landmarks,
                                    const std::set<KeyframeId>& free, std::size_t count) {
  std::map<KeyframeId, int> seen;
  for (const LandmarkId id : landmarks) {
    for (const Observation& observation : atlas.FindLandmark(id)->observations) {
      if (!free.contains(observation.keyframe)) ++seen[observation.keyframe];
    }
  }
  std::vector<std::pair<int, KeyframeId>> ranked;
  for (const auto& [keyframe, number] : seen) ranked.emplace_back(-number, keyframe);
  std::sort(ranked.begin(), ranked.end());
  std::vector<KeyframeId> fixed;
  for (std::size_t i = 0; i < std::min(count, ranked.size()); ++i) fixed.push_back(ranked[i].second);
  return fixed;
}

}  // namespace

AdjustmentWindow ChooseAdjustmentWindow(const Atlas& atlas, KeyframeId newest,
                                        const LocalBundleAdjustmentOptions& options) {
  AdjustmentWindow window;
  const std::vector<KeyframeId> near = GrowWindow(atlas, newest, options.window_keyframes);
  // The root holds the map's origin.
  std::copy_if(near.begin(), near.end(), std::back_inserter(window.free), [&](KeyframeId id) {
    const Keyframe& keyframe = *atlas.FindKeyframe(id);
    return !IsRoot(keyframe) && !IsReadOnly(keyframe, newest.session);
  });
  std::sort(window.free.begin(), window.free.end());
  for (const LandmarkId id : LandmarksSeenBy(atlas, window.free)) {
    const Landmark& landmark = *atlas.FindLandmark(id);
    const bool held = IsReadOnly(atlas, landmark, newest.session);
    auto& kind = held ? window.held : landmark.observations.size() > 1 ? window.landmarks : window.carried;
    kind.push_back(id);
  }
  std::set<KeyframeId> free(window.free.begin(), window.free.end());
  window.fixed = ChooseFixed(atlas, window.landmarks, free, options.fixed_keyframes);
  const bool held = window.held.size() >= kHoldingLandmarks;
  if (window.fixed.empty() && !window.free.empty() && !held) {
    // Without a fixed keyframe the gauge drifts: the oldest holds it.
    window.fixed.push_back(window.free.front());
    window.free.erase(window.free.begin());
    std::erase_if(window.carried,
                  [&](LandmarkId id) { return atlas.FindLandmark(id)->reference == window.fixed.front(); });
  }
  return window;
}

}  // namespace pangaea
