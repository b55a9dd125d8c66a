#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "cli/evaluation.h"
#include "cli/truth.h"
#include "common/base/result.h"

namespace pangaea {

// Reads the stores of sessions that ran alone, each with a server of its own, and says by session name what came of
// them. kInvalidArgument where a name occurs twice.
Result<std::map<std::string, SingleRun>> ReadSingleRuns(const std::vector<std::string>& stores,
                                                        std::span<const Truth> truths,
                                                        const AbsoluteErrorOptions& options);

// Puts each single run beside the session of its name.
void CompareWithSingleRuns(const std::map<std::string, SingleRun>& runs, std::vector<MapEvaluation>& evaluations);

}  // namespace pangaea
