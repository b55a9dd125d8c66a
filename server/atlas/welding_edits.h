#pragma once

#include <optional>
#include <vector>

#include "common/base/result.h"
#include "common/map/atlas.h"
#include "common/map/edits/edits.h"
#include "server/fusion/look_memory.h"
#include "server/fusion/welding.h"
#include "server/ingest/server_proposal.h"
#include "server/optimization/correction.h"

namespace pangaea {

// What a plan makes of the atlas as it is now: its edits as far as they fit, its correction rebased, and where it is
// given the correction that spreads it over the map, rebased on top. An error where the plan makes no sense any more.
Status WeldingEdits(const WeldingPlan& plan, const std::optional<Correction>& spread, ServerDraft& draft);

// What an optimisation of a map found, against the snapshot it worked on; in the order in which it is applied.
struct OptimizedMap {
  std::vector<MapEdit> joins;           // of duplicates; they move nothing
  std::vector<Correction> corrections;  // each against the atlas as those before made it
  std::vector<MapEdit> removals;        // of what contradicts them
  // Once all that was taken: where the next look for duplicates need not look again. Nothing where none was made.
  std::optional<LookedAtMap> looked_at = {};
};
// The same of the atlas as it is now. An error where it does not fit.
Status OptimizationEdits(const OptimizedMap& optimized, ServerDraft& draft);

}  // namespace pangaea
