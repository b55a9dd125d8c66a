#pragma once

#include <cstddef>
#include <set>
#include <stop_token>
#include <vector>

#include "common/base/result.h"
#include "common/map/atlas.h"
#include "common/map/edits/edits.h"

namespace pangaea {

struct ThinningOptions {
  // Landmarks that a keyframe keeps however weak they are (count): a frame is tracked on up to 300, and not all are
  // found again.
  std::size_t kept = 350;
  // ... and in each cell of its image, so that what is kept lies all over it (count).
  std::size_t kept_in_cell = 4;
  int cell = 94;  // edge of a cell, pixels: 8 x 5 cells of a picture of 752 x 480
  // Landmarks that more keyframes than this see are not weak: they tie the map together (count).
  std::size_t max_observers = 4;

  // Says which option is out of which range.
  Status Check() const;
};

// The weak landmarks that the map can do without: each keyframe that sees one keeps enough others, also around it.
// Those that fewest keyframes see go first, of equals those seen from the narrowest angle. Landmarks that keyframes of
// several sessions see stay, and whatever a keyframe of `in_use` sees. A stop ends it early: the edits so far are good.
std::vector<MapEdit> PlanThinning(const Atlas& atlas, MapId map, const std::set<KeyframeId>& in_use,
                                  const ThinningOptions& options, std::stop_token stop);

}  // namespace pangaea
