#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "common/base/result.h"
#include "common/mapping/bundle_window.h"
#include "common/mapping/landmark_visits.h"
#include "common/mapping/measurement_noise.h"
#include "server/optimization/correction.h"

namespace pangaea {

struct GlobalBundleOptions {
  MeasurementNoiseOptions noise = {};
  VisitOptions visits = {};
  int iterations = 10;                   // steps with all observations
  int iterations_without_outliers = 10;  // then so many without the outliers these showed, with a narrower kernel
  double cost_tolerance = 1e-3;          // a phase ends when a step lowers the cost by less than this, relatively
  // What contradicts the adjusted map is judged by the noise that the map itself shows, which is mostly less than
  // noise.pixel_sigma: by that, what is off by a pixel or two, as a neighbouring corner taken for the same one is,
  // would stay and bend the map (docs/decisions/0025-noise-of-a-map.md). Not below this, in pixel_sigma: corners are
  // found on a grid of pixels, which alone makes 0.29.
  double least_noise = 0.3;
  // A keyframe with fewer observations (count) keeps its pose relative to its parent: six unknowns want some
  // redundancy.
  std::size_t min_observations = 10;
  // Maps with more pairs of covisible keyframes are solved by conjugate gradients, whose memory grows with the
  // observations alone. The direct solver's grows with the pairs, 300 bytes each, and with what its factor fills in,
  // at worst the square of 6 x 8 bytes a keyframe: 5,000 keyframes of a long flight have 150,000 pairs, 775 that all
  // see one room 300,000.
  std::size_t direct_pairs = 300000;
  // Of those larger maps, whose solver reads the clock itself: seconds of each of the two phases, after which the best
  // state so far is taken. 0: no limit. For the others, see AdjustMap.
  double max_seconds = 60.0;
  int threads = 1;  // of those larger maps

  Status Check() const;
};

// All keyframes and landmarks of a map that were seen at least twice: the root is fixed, all else is free.
BundleWindow WholeMap(const Atlas& atlas, MapId map);

struct GlobalBundle {
  // Against the snapshot: every keyframe but the root, and the landmarks of at least two views. Those of one view
  // follow.
  Correction correction;
  std::vector<MapEdit> removals;  // of observations that contradict the adjusted map, and of what loses its last ones
  std::size_t observations = 0;
  std::size_t outliers = 0;
  double final_cost = 0.0;  // half the sum of the narrower kernel of the squared residuals, in sigmas; of the inliers
  int iterations = 0;
};

// Adjusts all keyframes and landmarks of a map to all that was seen. The root keeps its pose. A map without a stereo
// camera has no scale of its own: it keeps its median depth.
// Nothing where there is no such map, too little in it to adjust, or a stop was requested: a bundle adjustment that was
// cut short is worth less than the one that will follow. `options` must pass their check.
// `out_of_time` is asked after every step of the direct solver: when it says so, the best state so far is taken.
std::optional<GlobalBundle> AdjustMap(const Atlas& snapshot, MapId map, const GlobalBundleOptions& options,
                                      std::stop_token stop, const std::function<bool()>& out_of_time = {});

}  // namespace pangaea
