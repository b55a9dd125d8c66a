#pragma once

#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "agent/runtime/agent_options.h"
#include "agent/runtime/flight_record.h"
#include "agent/runtime/stage_clock.h"
#include "common/base/result.h"
#include "common/map/atlas.h"

namespace pangaea {

// Everything a finished run can tell.
struct AgentRun {
  SessionId session = 0;
  std::string name;
  SourceCounters source;
  FlightRecord flight;
  std::shared_ptr<const Atlas> atlas;
  Rigid3d body_from_camera;
  std::map<std::string, StageStatistics> stages;
  double wall_seconds = 0.0;
  double cpu_seconds = 0.0;  // of the whole process, all threads
  double peak_rss_mib = 0.0;
  UplinkCounters uplink;
  bool acknowledged = false;  // the server confirmed that it holds everything
  // Why it did not, where there should have been a server: kUnavailable (the spill file has the rest), kRefused.
  std::optional<Error> unconfirmed;
};

// Runs one session over a dataset: the source, tracking, mapping and uplink threads, or all of it on this thread when
// options.deterministic. `stop` ends it early and in order; `hurry` also ends the waiting for the server's last acks.
// Fails when the dataset, the options or the link's setup are unusable; an absent server is no failure.
Result<AgentRun> RunAgent(const AgentOptions& options, const std::stop_token& stop, const std::stop_token& hurry = {});

}  // namespace pangaea
