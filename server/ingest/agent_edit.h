#pragma once

#include "common/base/result.h"
#include "common/map/atlas.h"
#include "common/map/edits/edits.h"

namespace pangaea {

// Applies an agent's edit to an atlas that the server itself has changed meanwhile, which the agent cannot know yet:
// where both say different things of one keypoint or landmark, the server's word stands and the edit changes nothing.
// A new landmark at a keypoint that shows one by now is that one: its id forwards to it. Everything else is as in
// Apply. Recovery and undo apply what is in the journal in the same way.
Status ApplyAgentEdit(const MapEdit& edit, Atlas& atlas);

}  // namespace pangaea
