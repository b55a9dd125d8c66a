#include "agent/mapping/keyframe_culling.h"

#include <algorithm>

#include "agent/absorption/absorption.h"
#include "common/mapping/keyframe_redundancy.h"

namespace pangaea {

std::optional<KeyframeId> FindRedundantKeyframe(const Atlas& atlas, const Keyframe& newest,
                                                const std::vector<KeyframeId>& kept, double close_depth_baselines,
                                                const KeyframeCullingOptions& options) {
  for (const Covisibility& neighbour : newest.covisible) {
    const Keyframe& keyframe = *atlas.FindKeyframe(neighbour.keyframe);
    if (IsReadOnly(keyframe, newest.id.session) || !keyframe.parent.valid() ||
        keyframe.id.counter + options.newest_kept > newest.id.counter)
      continue;
    if (std::find(kept.begin(), kept.end(), keyframe.id) != kept.end()) continue;
    // One octave coarser is no loss.
    const RedundancyCriterion criterion{.other_observers = options.other_observers,
                                        .coarser_octaves = 1,
                                        .max_depth = close_depth_baselines * keyframe.data->camera.baseline};
    if (RedundantShare(atlas, keyframe, criterion) > options.redundant_ratio) return keyframe.id;
  }
  return std::nullopt;
}

}  // namespace pangaea
