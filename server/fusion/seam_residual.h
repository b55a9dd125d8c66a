#pragma once

#include <cstddef>
#include <vector>

#include "common/mapping/bundle_window.h"

namespace pangaea {

// How well poses and points explain what was seen, in sigmas.
struct SeamResidual {
  std::size_t observations = 0;
  std::size_t inliers = 0;   // within the 95 % quantiles
  double cost = 0.0;         // robust (Huber), sum
  double inlier_cost = 0.0;  // squares of the inliers, sum

  double mean_cost() const;     // per observation; 0 without any
  double inlier_share() const;  // 0 without any
  double rms_inliers() const;   // of an inlier's error, all its components together
  SeamResidual& operator+=(const SeamResidual& other);
};

// Of the observations of these landmarks, at the poses and points of the problem. Ascending, as those of the bundle.
SeamResidual MeasureResidual(const WindowBundle& bundle, const std::vector<LandmarkId>& landmarks);

// Of what the keyframes see together, as it stands in the atlas.
SeamResidual MeasureResidual(const Atlas& atlas, const std::vector<KeyframeId>& keyframes,
                             const MeasurementNoiseOptions& noise);

}  // namespace pangaea
