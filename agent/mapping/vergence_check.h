#pragma once

#include <optional>
#include <stop_token>

#include "agent/mapping/local_mapping_options.h"
#include "common/map/atlas.h"

namespace pangaea {

struct VergenceFinding {
  // False where nothing can be said: a monocular camera, too few keyframes, a stop, an estimate that fails, or
  // keyframes elsewhere that are forgotten.
  bool could_tell = false;
  // The vergence (radians, from the calibration) that was found better than the present one.
  std::optional<double> better;
};

// The vergence of the rig that the newest keyframe and its session's around it speak for, where it differs from the one
// they have by more than chance and more than is worth a correction. Keyframes elsewhere, where there are enough, have
// to speak for it, too: of the two the smaller change is taken. Reads poses and landmarks as a first guess only.
VergenceFinding FindBetterVergence(const Atlas& atlas, KeyframeId newest, const VergenceOptions& options,
                                   const MeasurementNoiseOptions& noise, const std::stop_token& stop);

}  // namespace pangaea
