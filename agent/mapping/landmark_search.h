#pragma once

#include <optional>
#include <vector>

#include "agent/mapping/local_mapping_options.h"
#include "common/map/atlas.h"
#include "common/map/edits/edits.h"

namespace pangaea {

// Looks for the landmarks (`wanted`, each once) among the keypoints of `keyframe` and says what follows: a keypoint
// without a landmark is a new observation; one that shows another landmark makes the two one, if they agree
// geometrically. Landmarks that the keyframe observes already are passed over. Each landmark and each keypoint is
// touched by at most one edit.
std::vector<MapEdit> SearchLandmarks(const Atlas& atlas, const Keyframe& keyframe,
                                     const std::vector<LandmarkId>& wanted, const LandmarkSearchOptions& options);

// Fusion of two landmarks that one keypoint suggests; the one with more observations is kept, of equals the older.
// Nothing when they contradict each other: a keyframe sees them at different pixels, or one point lies further than
// `gate` octave pixels from where a keyframe saw the other one.
std::optional<MapEdit> FuseIfTheyAgree(const Atlas& atlas, const Landmark& a, const Landmark& b, double gate);

}  // namespace pangaea
