#pragma once

#include <cstddef>
#include <set>
#include <stop_token>
#include <vector>

#include "common/base/result.h"
#include "common/map/atlas.h"
#include "common/map/edits/edits.h"

namespace pangaea {

struct RedundancyOptions {
  // A keyframe may go when this part of its landmarks is seen from so many others (count), on the same octave or a
  // finer one, or on one coarser by so much, as octaves are rounded (Mur-Artal and Tardos 2015, section VI-E).
  double redundant_share = 0.9;
  std::size_t other_observers = 3;
  int coarser_octaves = 1;
  // Keyframes and landmarks of the site may take so many bytes of memory; what is redundant goes only while they take
  // more. 0: all that is redundant goes.
  std::size_t max_bytes = 0;
  // When redundant keyframes were not enough, landmarks that fewer keyframes than this see go as well (count): they tie
  // nothing together. 1: none.
  std::size_t min_landmark_observers = 2;

  // Says which option is out of which range.
  Status Check() const;
};

// What keyframes and landmarks of an atlas take in memory, nearly.
std::size_t EstimateBytes(const Atlas& atlas);

// The keyframes and landmarks that the atlas can do without, the most redundant first. Never the root of a map, an end
// of a loop edge, or one of `in_use` (what live agents still work on) and the landmarks these see. A stop ends it
// early: the edits so far are good.
std::vector<MapEdit> PlanCulling(const Atlas& atlas, const std::set<KeyframeId>& in_use,
                                 const RedundancyOptions& options, std::stop_token stop);

// The same of the keyframes of one map: all that are redundant, whatever the memory.
std::vector<MapEdit> PlanKeyframeCulling(const Atlas& atlas, MapId map, const std::set<KeyframeId>& in_use,
                                         const RedundancyOptions& options, std::stop_token stop);

}  // namespace pangaea
