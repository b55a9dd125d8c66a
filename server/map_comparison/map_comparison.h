#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "common/geometry/similarity3.h"
#include "common/map/atlas.h"
#include "server/map_comparison/map_comparison_options.h"
#include "server/place_recognition/place_match.h"

namespace pangaea {

// How far a comparison came, in the order of its steps.
enum class MapComparisonOutcome {
  kNotComparable,     // a map is not alive, has no scale, or is too small
  kNoMotion,          // no motion that several matches agree on
  kAmbiguous,         // another motion fits nearly as well
  kFewPairs,          // too few landmarks lie on one that looks alike
  kNarrow,            // all of these stand close together
  kSmallOverlap,      // most of either map lies where the other is not
  kSurfacesDisagree,  // the landmarks of one map do not lie where those of the other do
  kOnePlace,
};
const char* ToString(MapComparisonOutcome outcome);

struct MapComparison {
  MapComparisonOutcome outcome = MapComparisonOutcome::kNotComparable;
  // Each 0 where the comparison did not come to it.
  std::size_t matches = 0;        // landmarks that look alike, by descriptors alone
  std::size_t support = 0;        // of these, that fit the best motion; at most two counted a cell
  std::size_t rival_support = 0;  // the same of the best motion of the others
  std::size_t pairs = 0;          // landmarks that lie on one that looks alike
  std::size_t cells = 0;          // in which they lie
  double overlap = 0.0;           // of the landmarks of the map of which more does, in cells where the other has some
  double surface_share = 0.0;     // of these, that lie on some landmark of the other
  Similarity3d candidate_from_query;  // of the map frames
  // Where they are one place: as if the two keyframes that see most of the pairs had been recognised.
  std::optional<PlaceMatch> match;
};

// Whether two maps show the same place although no keyframe of one looks like a keyframe of the other: a room whose
// pictures and furniture were rearranged, another season's light. A single view holds too few of the things that
// stayed: five of 500 landmarks in view, where chance gives as many. A map holds dozens, all over the place and all
// under one motion, and its walls lie on the other's walls. Compares the landmarks of both by their descriptors alone,
// seeks the motion on which most agree (RANSAC on Horn's closed form), seeks the pairs that lie on each other under it,
// and asks for as much evidence as a whole map can give (docs/decisions/0027-rearranged-rooms.md). Maps with metric
// scale alone. A tenth of a second for maps of 5,000 landmarks; deterministic.
MapComparison CompareMaps(const Atlas& atlas, MapId query, MapId candidate, const MapComparisonOptions& options);

// In one line, with the figures.
std::string Describe(const MapComparison& comparison);

}  // namespace pangaea
