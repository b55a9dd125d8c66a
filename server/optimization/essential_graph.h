#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/similarity3.h"
#include "common/map/atlas.h"

namespace pangaea {

// A measured motion between two keyframes of one map.
struct PoseGraphEdge {
  KeyframeId from;
  KeyframeId to;
  Similarity3d to_from_from;       // camera frame of `from` to camera frame of `to`, lengths as before the seam
  std::uint32_t shared_landmarks;  // what the measurement rests on
};

// The essential graph of a map (Mur-Artal et al. 2015, section III-D): the edges of the spanning tree, of strong
// covisibility, and of loops. Motions are taken from the poses of `before_seam`, where what drift did to them is spread
// over all of the map and not yet torn at the seam; those of loops that only `after_seam` knows, as measured. Where
// `before_seam` does not have both ends in this map, from the poses of `after_seam`. Tree and keyframes are those of
// `after_seam`; empty where it has no such map.
std::vector<PoseGraphEdge> EssentialGraph(const Atlas& before_seam, const Atlas& after_seam, MapId map,
                                          std::uint32_t min_shared_landmarks);

}  // namespace pangaea
