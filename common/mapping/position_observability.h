#pragma once

#include "common/base/result.h"
#include "common/estimation/pose_refinement.h"

namespace pangaea {

// When a camera's position counts as unknown although enough landmarks are matched (Elvira et al., "ORBSLAM-Atlas",
// 2019, section "Camera pose observability"): distant ones tell the direction alone.
struct ObservabilityOptions {
  // Where the map has a scale: the largest standard deviation of the position along an axis, metres. Indoors it is
  // mostly a millimetre, between houses a centimetre, and half a decimetre for the first frame that recognises a place
  // from afar. A map is made of relative poses between keyframes half a metre apart: a decimetre is a fifth of that,
  // and a few such links would bend the map more than all the others together.
  double max_sigma_m = 0.1;
  // In a monocular map, which has none: the same as a share of the median depth of the matched landmarks.
  double max_sigma_of_depth = 0.02;

  Status Check() const;
};

// The test of Eq. (1) there: max(sigma_x, sigma_y, sigma_z) < sigma_t, from the information of the pose on the matched
// landmarks, which are held fixed. What they are uncertain themselves is in the matches' sigmas (PredictionVariance).
// `median_depth` of the matched landmarks counts where the map is not `metric`.
bool PositionIsObservable(const RefinedPose& pose, double median_depth, bool metric,
                          const ObservabilityOptions& options);

}  // namespace pangaea
