#pragma once

#include <cstddef>
#include <span>

#include "common/map/atlas.h"
#include "common/mapping/measurement_noise.h"

namespace pangaea {

// How much of what was seen contradicts the map. Adjustments remove what contradicts their result, so that a map is
// strained only where keyframes outside of their windows see what they have moved: where the camera came back to an old
// place by a way that has drifted.
struct MapStrain {
  std::size_t observations = 0;
  std::size_t contradicting = 0;  // beyond their 95 % quantile, or behind the camera

  double share() const {
    return observations == 0 ? 0.0 : static_cast<double>(contradicting) / static_cast<double>(observations);
  }
};

// Of all observations of every so many landmarks, about `samples` of them (count, > 0), whichever keyframe made them.
// Landmarks that are gone are passed over.
MapStrain StrainOf(const Atlas& atlas, std::span<const LandmarkId> landmarks, std::size_t samples,
                   const MeasurementNoiseOptions& noise);

}  // namespace pangaea
