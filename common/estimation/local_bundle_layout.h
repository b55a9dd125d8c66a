#pragma once

#include <vector>

#include "common/estimation/bundle_phase.h"
#include "common/estimation/local_bundle_view.h"

namespace pangaea::local_bundle {

// A run of measurements [begin, end) of one point; those up to `free_end` are by free poses, in their order.
struct Track {
  int begin, free_end, end;
  int point;
  bool fixed;
};

// A problem's active observations in the order of their elimination.
struct Layout {
  std::vector<Camera> cameras;  // per pose
  std::vector<int> free_poses;  // variable -> index of the pose
  std::vector<Measurement> measurements;
  std::vector<Track> tracks;
};

Layout MakeLayout(const BundlePhase& phase, const BundleState& state);

}  // namespace pangaea::local_bundle
