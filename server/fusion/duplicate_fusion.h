#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "server/fusion/welding_draft.h"
#include "server/fusion/welding_window.h"

namespace pangaea {

// Makes of both sides' landmarks one set (Elvira et al. 2019, section "Seamless map merging", step 3). First the pairs
// that are known to be the same, then the landmarks of each side are looked for in the keyframes of the other: new
// observations, and duplicates that become one. Two are fused where they agree geometrically: one point lies within
// options.fusion_gate octave pixels of wherever keyframes of the window saw them. It becomes the position.
void FuseAcrossSeam(const WeldingWindow& window, const std::vector<std::pair<LandmarkId, LandmarkId>>& pairs,
                    const LandmarkSearchOptions& options, WeldingDraft& draft);

// The landmarks that keyframes of both sides see, ascending.
std::vector<LandmarkId> CommonLandmarks(const Atlas& atlas, const WeldingWindow& window);

}  // namespace pangaea
