#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/base/result.h"
#include "common/estimation/bundle_adjustment.h"
#include "common/mapping/bundle_window.h"

namespace pangaea {

// A session visits a landmark as long as its keyframes go on seeing it. Within a visit a corner is followed from
// keyframe to keyframe, to a tenth of a pixel. On the next visit, or by another session, it was found anew, a third of
// a pixel beside in the median, and everything in that visit lies beside as far (docs/decisions/0033-visits.md).
struct VisitOptions {
  // A visit ends where the next of the bundle's keyframes of the session that sees the landmark was made so many
  // keyframes later or more, those counted that have been culled.
  std::uint32_t gap = 15;
  // How much less exactly (ratio of standard deviations) a keypoint says where the corner of another visit is.
  double sigma_ratio = 2.5;

  Status Check() const;
};

// The bundle's problem with a point for every visit.
struct VisitBundle {
  // Poses are those of the bundle, in the same order. The point of a landmark's first visit has the landmark's index,
  // those of the others come after all landmarks.
  BundleProblem problem;
  std::vector<std::size_t> observations;  // for each of the bundle the same one here; the rest are ties
  // For each landmark of several visits the point of the one with most observations; -1 for the others.
  std::vector<int> longest_visit;
};

// Each visit's point is tied to that of the nearest view among the earlier visits: both keyframes see the other's point
// as well, at their own keypoint, with the larger standard deviation. A landmark that is fixed is left as it is.
// `options` have passed Check().
VisitBundle SplitByVisits(const WindowBundle& bundle, const VisitOptions& options);

// Moves the poses as the visits of the landmarks say, and then, with the poses held, each landmark of several visits to
// where all of them together see it. Points and outliers are those of the bundle: an outlier contradicts where its
// landmark came to lie. Costs, `iterations` and `converged` are the first step's, which `solver` is for; a stop ends
// that one early, and the second follows. Errors as SolveBundle.
Result<BundleResult> SolveByVisits(const WindowBundle& bundle, const VisitOptions& options,
                                   const BundleOptions& solver);

}  // namespace pangaea
