#pragma once

#include <vector>

#include "common/map/atlas.h"
#include "common/map/edits/edits.h"

namespace pangaea {

// What of a landmark search (SearchLandmarks) the agent of `session` may do: keyframes of other sessions get no
// observations, two landmarks of other sessions stay two, and of two that become one the read-only one (IsReadOnly) is
// kept.
std::vector<MapEdit> RespectOthers(const Atlas& atlas, SessionId session, std::vector<MapEdit> edits);

}  // namespace pangaea
