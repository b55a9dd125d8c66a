#pragma once

#include <optional>
#include <vector>

#include "common/base/result.h"
#include "common/map/atlas.h"
#include "common/map/edits/edits.h"
#include "server/fusion/welding.h"
#include "server/optimization/correction.h"

namespace pangaea {

// What a plan makes of the atlas as it is now: its edits as far as they fit, its correction rebased, and where it is
// given the correction that spreads it over the map, rebased on top. An error where the plan makes no sense any more.
Result<std::vector<MapEdit>> WeldingEdits(const WeldingPlan& plan, const std::optional<Correction>& spread,
                                          const Atlas& current);

// A correction and the removals that go with it, made of the atlas as it is now. An error where they do not fit.
Result<std::vector<MapEdit>> CorrectionEdits(const Correction& correction, const std::vector<MapEdit>& removals,
                                             const Atlas& current);

// The atlas with a correction made of it: where a plan ends on the snapshot it was made on.
Atlas Corrected(const Atlas& atlas, const Correction& correction);

}  // namespace pangaea
