#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <stop_token>

#include "common/base/result.h"
#include "server/optimization/correction.h"

namespace pangaea {

struct PoseGraphOptions {
  // Covisible keyframes that share so many landmarks are tied to each other (count; Mur-Artal et al. 2015, section
  // III-D): with fewer the graph grows dense and the result hardly changes.
  std::uint32_t strong_covisibility = 100;
  // An edge counts as if it rested on at least so many landmarks: ends of a tree edge may share none any more.
  std::uint32_t few_landmarks = 15;
  int iterations = 30;           // Levenberg-Marquardt steps
  double cost_tolerance = 1e-6;  // done when a step lowers the cost by less than this, relatively
  int threads = 1;
  double max_seconds = 0.0;  // 0: no limit; the best state so far is taken

  Status Check() const;
};

struct PoseGraphResult {
  Correction correction;  // against `after_seam`; names the keyframes that are not held
  std::size_t edges = 0;
  double initial_cost = 0.0;  // half the sum of squared, weighted errors of the edges
  double final_cost = 0.0;
  int iterations = 0;
};

// Spreads over a map what was corrected at a seam (Mur-Artal et al. 2015, section VII-D). `before_seam` is the map
// before the seam was corrected (of a merge: brought into one frame, but not yet welded), `after_seam` with its welding
// window corrected. `held`: the keyframes of the window, which stay where `after_seam` has them, each with the factor
// by which the seam multiplied the lengths around it (1 in a metric map). With none held, the root is. Keyframes of
// stereo cameras move in SE(3), those of monocular cameras in Sim(3); landmarks follow. Nothing where `after_seam` has
// no such map or a stop was requested. `options` must pass their check.
std::optional<PoseGraphResult> OptimizePoseGraph(const Atlas& before_seam, const Atlas& after_seam, MapId map,
                                                 const std::map<KeyframeId, double>& held,
                                                 const PoseGraphOptions& options, std::stop_token stop);

}  // namespace pangaea
