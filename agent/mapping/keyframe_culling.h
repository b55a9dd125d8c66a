#pragma once

#include <optional>
#include <vector>

#include "agent/mapping/local_mapping_options.h"
#include "common/map/atlas.h"

namespace pangaea {

// A covisible keyframe of `newest` that says nothing new: nearly all of its landmarks are seen by enough other
// keyframes on the same or a finer octave (Mur-Artal and Tardos 2015, section VI-E). Stereo keyframes are judged by
// their near landmarks, within `close_depth_baselines`. Never the root, one that is read-only (IsReadOnly), one of
// `kept`, or one of the newest. The oldest such one; remove it before asking again.
std::optional<KeyframeId> FindRedundantKeyframe(const Atlas& atlas, const Keyframe& newest,
                                                const std::vector<KeyframeId>& kept, double close_depth_baselines,
                                                const KeyframeCullingOptions& options);

}  // namespace pangaea
