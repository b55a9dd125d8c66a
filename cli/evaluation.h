#pragma once

#include <optional>
#include <vector>

#include "cli/stored_atlas.h"
#include "common/base/result.h"
#include "common/evaluation/evaluation_report.h"

namespace pangaea {

// The sessions of one map, each alone, and under one alignment where several have truth.
struct MapEvaluation {
  MapId map;
  EvaluationReport report;  // a row for each part of the map, in their order
  // The frame of the truths, as all sessions with truth say together; none where no session has it.
  std::optional<Similarity3d> truth_from_map;
};

// One for each map of `stored` that holds frames, in their order. Sessions without truth get rows without an error.
Result<std::vector<MapEvaluation>> EvaluateMaps(const StoredAtlas& stored, const AbsoluteErrorOptions& options);

// Trajectories of files: each alone, and `jointly` under one alignment.
Result<EvaluationReport> EvaluateTrajectories(std::span<const EvaluatedTrajectory> trajectories, bool jointly,
                                              const AbsoluteErrorOptions& options);

// Pairs each file of a trajectory with the truth at the same place of the other list. With `of_camera` the left
// camera's positions are compared instead of the body's.
Result<std::vector<EvaluatedTrajectory>> ReadTrajectories(const std::vector<std::string>& files,
                                                          std::span<const Truth> truths, bool of_camera);

}  // namespace pangaea
