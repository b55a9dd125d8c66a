#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "agent/runtime/agent_run.h"

namespace pangaea {

// The report for programs; its keys are listed in docs/evaluation.md.
nlohmann::json ReportOf(const AgentRun& run);
// The same for people, several lines.
std::string SummaryOf(const AgentRun& run);
// Writes what the options ask for: the trajectory (one file per map, the largest first: OUT.tum, OUT.2.tum, …), the
// live trajectory and the report.
Status WriteOutputs(const AgentOptions& options, const AgentRun& run);

}  // namespace pangaea
