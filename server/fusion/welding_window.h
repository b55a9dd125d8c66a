#pragma once

#include <cstddef>
#include <vector>

#include "common/map/atlas.h"
#include "server/fusion/fusion_options.h"
#include "server/fusion/seam.h"

namespace pangaea {

// The keyframes around a seam (Elvira et al. 2019, section "Seamless map merging", step 4).
struct WeldingWindow {
  std::vector<KeyframeId> kept;   // the kept end of the seam and those around it, nearest first
  std::vector<KeyframeId> moved;  // the moved end and those around it, nearest first; none is also in `kept`
  // Hold the kept side in place: its map's root where it is near, and keyframes around it that see its landmarks. Never
  // empty, at least two where the map is scale-free; those that are also in `kept` are held, too.
  std::vector<KeyframeId> fixed;
};

// In the atlas as it is before anything is welded.
WeldingWindow GrowWeldingWindow(const Atlas& atlas, const Seam& seam, const WeldingWindowOptions& options);

}  // namespace pangaea
