#pragma once

#include <optional>
#include <stop_token>

#include "agent/mapping/local_mapping_options.h"
#include "common/map/atlas.h"

namespace pangaea {

// The vergence of the rig (radians, from the calibration) that the newest keyframe and its session's around it speak
// for, where it differs from the one they have by more than chance and more than is worth a correction. Keyframes
// elsewhere, where there are enough, have to speak for it, too: of the two the smaller change is taken. Reads poses and
// landmarks as a first guess only. Nothing for a monocular camera, with too few keyframes, where those elsewhere are
// forgotten, or when a stop is requested.
std::optional<double> FindBetterVergence(const Atlas& atlas, KeyframeId newest, const VergenceOptions& options,
                                         const MeasurementNoiseOptions& noise, const std::stop_token& stop);

}  // namespace pangaea
