#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "common/geometry/similarity3.h"
#include "common/map/atlas.h"
#include "common/map/metric_map.h"
#include "server/place_recognition/place_match.h"

namespace pangaea {

// Where two pieces of map meet: two maps to be merged, or the two ends of a loop. One side is kept where it is, the
// other is moved onto it.
struct Seam {
  KeyframeId kept;
  KeyframeId moved;
  MapId kept_map;
  MapId moved_map;               // the same for a loop
  Similarity3d kept_from_moved;  // map frames, lengths of each map; of a loop: where the moved end should be, from
                                 // where it is
  bool scale_free = false;       // lengths of the kept map are not metres
  std::vector<std::pair<LandmarkId, LandmarkId>> landmarks;  // kept, moved: alive, each pair once

  bool is_merge() const { return kept_map != moved_map; }
};

// Which of two maps survives their merge: a metric one beats a scale-free one, then the one whose root was taken
// earlier, then the lower id. The same whichever is named first.
MapId Survivor(const Atlas& atlas, MapId a, MapId b);

// The match as it stands in this atlas: what was culled or fused since is replaced by what it forwards to. Of two maps
// the survivor is kept; of a loop the recognised end. Nothing where an end or its map is gone, or both ends are one.
std::optional<Seam> FindSeam(const Atlas& atlas, const PlaceMatch& match);

}  // namespace pangaea
