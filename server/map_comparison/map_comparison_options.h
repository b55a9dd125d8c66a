#pragma once

#include <cstddef>
#include <cstdint>

#include "common/base/result.h"
#include "common/features/matching.h"

namespace pangaea {

// When two maps that no keyframe joins are believed to show one place all the same.
struct MapComparisonOptions {
  // Landmarks that are compared: seen so often, and of these so many a map. Of a larger map a part is compared, and
  // what two large maps have in common is missed the more, the larger they are.
  std::size_t min_observations = 3;
  std::size_t max_landmarks = 8000;
  // Of landmarks without an idea of the motion. Stricter than for two keyframes: here a whole map may be mistaken.
  MatchOptions matching = {.max_distance = 40, .max_ratio = 0.8};
  int ransac_iterations = 100'000;
  // How far apart two landmarks that are one may lie, and the edge of the cells by which is counted how widely pairs
  // are spread, both in scene depths (the median distance of landmarks from their cameras, in the nearer of the two
  // maps).
  double tolerance = 0.025;
  double cell = 0.3;
  // Descriptor distance of a pair once the motion is known: unrelated ones differ in 128 ± 20 bits.
  int guided_distance = 50;
  // What the pairs under the motion must come to: so many, in so many cells. A thing that stands in both places, or was
  // moved within one, fills a few cells.
  std::size_t min_pairs = 25;
  std::size_t min_cells = 10;
  // The matches that fit the motion, at most two counted a cell, must be so many times those that fit the best motion
  // of the rest: a hall of equal bays has several of equal worth.
  double min_lead = 2.0;
  // This share of the landmarks of one of the maps must lie in cells where the other has landmarks, too: it is the same
  // room as a whole. Rooms that overlap a little are joined where a keyframe sees it.
  double min_overlap = 0.8;
  // Of these, this share must have one of the other's landmarks so near (scene depths), whatever it looks like: walls
  // stay where they are.
  double min_surface_share = 0.4;
  double surface_tolerance = 0.035;
  std::uint64_t seed = 1;  // the same maps with the same seed give the same answer

  // Says which option is out of which range.
  Status Check() const;
};

}  // namespace pangaea
