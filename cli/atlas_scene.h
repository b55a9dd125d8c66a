#pragma once

#include <span>
#include <vector>

#include "cli/evaluation.h"
#include "cli/stored_atlas.h"
#include "cli/truth.h"
#include "common/evaluation/plot.h"

namespace pangaea {

// The picture of a store's maps. Maps with truth are drawn in the frame of the truth; those that share no frame with
// others stand beside them. `evaluations` are of the same `stored`.
PlotScene SceneOf(const StoredAtlas& stored, std::span<const MapEvaluation> evaluations, std::span<const Truth> truths);

// The picture of trajectories from files, each aligned to the truth at the same place of the list by the row at that
// place of the report.
PlotScene SceneOf(std::span<const EvaluatedTrajectory> trajectories, std::span<const Truth> truths,
                  const EvaluationReport& report);

}  // namespace pangaea
