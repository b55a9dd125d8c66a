#pragma once

#include "common/base/result.h"
#include "common/estimation/bundle_adjustment.h"
#include "common/mapping/bundle_window.h"

namespace pangaea {

// A session visits a landmark as long as its keyframes go on seeing it. Within a visit a corner is followed from
// keyframe to keyframe, to a tenth of a pixel. On the next visit, or by another session, it was found anew, up to half
// a pixel beside, and everything in that visit lies beside as far
// (docs/decisions/0033-visits.md).
struct VisitOptions {
  // A visit ends where more than so many keyframes of the session, one after the other, do not see the landmark.
  int gap = 10;
  // How much less exactly (ratio of standard deviations) a keypoint says where the corner of another visit is.
  double sigma_ratio = 2.5;

  Status Check() const;
};

// The bundle's problem with a point for every visit: the first visit's has the landmark's index, those of the others
// come after all landmarks. Each point is tied to that of the nearest view among the earlier visits: both keyframes see
// the other's point as well, at their own keypoint, with the larger standard deviation. Poses are those of the bundle,
// in the same order. `options` have passed Check().
BundleProblem SplitByVisits(const WindowBundle& bundle, const VisitOptions& options);

}  // namespace pangaea
