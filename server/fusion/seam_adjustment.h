#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <vector>

#include "common/mapping/bundle_window.h"
#include "server/fusion/fusion_options.h"
#include "server/fusion/welding_draft.h"
#include "server/fusion/welding_window.h"

namespace pangaea {

// A piece of map after its bundle adjustment: the problem's poses and points are the adjusted ones.
struct SeamAdjustment {
  WindowBundle bundle;
  std::vector<std::uint8_t> outliers;  // per observation of the problem
};

// The landmarks that at least two of the keyframes see: those that tie them together. Ascending.
std::vector<LandmarkId> TyingLandmarks(const Atlas& atlas, const std::vector<KeyframeId>& keyframes);

// Adjusts both sides of the window together, its fixed keyframes held (Elvira et al. 2019, section "Seamless map
// merging", step 4). Nothing when it was cancelled.
std::optional<SeamAdjustment> AdjustSeam(const Atlas& atlas, const WeldingWindow& window, const FusionOptions& options,
                                         std::stop_token stop);

// The draft takes the adjusted poses and points and loses the outliers.
void TakeAdjustment(const SeamAdjustment& adjustment, WeldingDraft& draft);

}  // namespace pangaea
