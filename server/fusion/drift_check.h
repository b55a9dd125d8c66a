#pragma once

#include <optional>

#include "common/map/atlas.h"
#include "server/fusion/fusion_options.h"
#include "server/fusion/seam.h"

namespace pangaea {

// What a loop says about the map between its ends: how far it had drifted, and how far it may have.
struct LoopDrift {
  double path = 0.0;             // length of the shortest verified way from end to end, map units
  double depth = 0.0;            // median distance of the landmarks at the kept end, map units
  double translation = 0.0;      // map units
  double rotation = 0.0;         // degrees
  double log_scale = 0.0;        // absolute
  double max_translation = 0.0;  // what is allowed, in the same units
  double max_rotation = 0.0;
  double max_log_scale = 0.0;

  bool is_plausible() const {
    return translation <= max_translation && rotation <= max_rotation && log_scale <= max_log_scale;
  }
};

// Compares the motion that a loop measured with the one the map predicts. The map's own error grows with the way
// between the ends: over edges of the spanning tree, covisibility and earlier loops. A loop that closed before makes
// the way short, and so what contradicts it is found out.
LoopDrift MeasureDrift(const Atlas& atlas, const Seam& loop, const DriftOptions& options);

}  // namespace pangaea
