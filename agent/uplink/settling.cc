#include "agent/uplink/settling.h"

#include <algorithm>

namespace pangaea {
namespace {

// Those of `waiting` that live, newest first.
std::vector<const Keyframe*> NewestFirst(const Atlas& atlas, const std::set<KeyframeId>& waiting) {
  std::vector<const Keyframe*> keyframes;
  for (const KeyframeId id : waiting) {
    if (const Keyframe* keyframe = atlas.FindKeyframe(id)) keyframes.push_back(keyframe);
  }
  std::stable_sort(keyframes.begin(), keyframes.end(),
                   [](const Keyframe* a, const Keyframe* b) { return a->data->stamp_ns > b->data->stamp_ns; });
  return keyframes;
}

int SharedLandmarks(const Keyframe& a, KeyframeId b) {
  const auto found = std::lower_bound(a.covisible.begin(), a.covisible.end(), b,
                                      [](const Covisibility& c, KeyframeId id) { return c.keyframe < id; });
  return found == a.covisible.end() || found->keyframe != b ? 0 : static_cast<int>(found->weight);
}

}  // namespace

Status SettlingOptions::Check() const {
  if (max_unsettled_seconds > 0.0 && window_keyframes >= 1 && window_covisibility >= 1) return {};
  return Fail(ErrorCode::kInvalidArgument,
              "settling: max_unsettled_seconds must be > 0, window_keyframes and window_covisibility >= 1");
}

std::vector<KeyframeId> SettledKeyframes(const Atlas& atlas, const std::set<KeyframeId>& waiting,
                                         std::int64_t newest_stamp_ns, const SettlingOptions& options) {
  std::vector<KeyframeId> settled;
  const std::vector<const Keyframe*> keyframes = NewestFirst(atlas, waiting);
  const auto max_age_ns = static_cast<std::int64_t>(options.max_unsettled_seconds * 1e9);
  for (std::size_t rank = 0; rank < keyframes.size(); ++rank) {
    const Keyframe& keyframe = *keyframes[rank];
    const bool old = newest_stamp_ns - keyframe.data->stamp_ns >= max_age_ns;
    const bool outside = rank >= static_cast<std::size_t>(options.window_keyframes) &&
                         SharedLandmarks(keyframe, keyframes.front()->id) < options.window_covisibility;
    if (old || outside || atlas.FindMap(keyframe.map)->closed) settled.push_back(keyframe.id);
  }
  std::sort(settled.begin(), settled.end());
  return settled;
}

}  // namespace pangaea
