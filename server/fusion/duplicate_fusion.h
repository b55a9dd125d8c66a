#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "server/fusion/welding_draft.h"
#include "server/fusion/welding_window.h"

namespace pangaea {

// Fuses pairs of landmarks that were found to be the same, where they agree geometrically: each lies within `gate`
// octave pixels of where the other was seen.
void FusePairs(const std::vector<std::pair<LandmarkId, LandmarkId>>& pairs, double gate, WeldingDraft& draft);

// Looks for the landmarks of each side in the keyframes of the other: new observations, and duplicates that become one
// (Elvira et al. 2019, section "Seamless map merging", step 3).
void FuseAcrossSeam(const WeldingWindow& window, const LandmarkSearchOptions& options, WeldingDraft& draft);

// The landmarks that keyframes of both sides see, ascending.
std::vector<LandmarkId> CommonLandmarks(const Atlas& atlas, const WeldingWindow& window);

}  // namespace pangaea
