#pragma once

#include "common/base/result.h"
#include "common/map/atlas.h"
#include "common/map/edits/edits.h"

namespace pangaea {

// Applies an agent's edit to an atlas that the server may have changed meanwhile, which the agent cannot know yet. Most
// of what they say of the same thing at the same time the edits themselves reconcile (AddObservation, AddLandmark);
// here goes what else is nobody's mistake: a landmark said anew that was fused into another, and relations between what
// is in two maps again. Such an edit changes nothing. A landmark said anew that lives is one that the agent had
// forgotten (common/map/forgetting.h): seen from one more keyframe, and there. Recovery and undo apply what is in the
// journal in the same way.
Status ApplyAgentEdit(const MapEdit& edit, Atlas& atlas);

}  // namespace pangaea
