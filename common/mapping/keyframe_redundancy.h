#pragma once

#include <cstddef>

#include "common/map/atlas.h"

namespace pangaea {

// When a keyframe says nothing new (Mur-Artal and Tardos 2015, section VI-E).
struct RedundancyCriterion {
  // A landmark is known without the keyframe when so many others see it (count) ...
  std::size_t other_observers = 3;
  // ... on an octave that is coarser by at most so much.
  int coarser_octaves = 0;
  // Only landmarks nearer than this are judged (map units; 0: all). Far ones hold the rotation alone.
  double max_depth = 0.0;
};

// The part of the keyframe's judged landmarks that are known without it; 0 where it has none.
double RedundantShare(const Atlas& atlas, const Keyframe& keyframe, const RedundancyCriterion& criterion);

}  // namespace pangaea
