#pragma once

#include "agent/tracking/local_map.h"
#include "agent/tracking/patch_search.h"
#include "common/mapping/position_observability.h"

namespace pangaea {

// Whether the camera's position is known well enough from the landmarks that the frame found in `local_map`.
bool PositionIsObservable(const LocatedFrame& located, const LocalMap& local_map, bool metric,
                          const ObservabilityOptions& options);

}  // namespace pangaea
