#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/runtime/atlas_service.h"
#include "server/runtime/work_report.h"

namespace pangaea {

// Digests that were asked for before: one is only computed anew when something was acknowledged or corrected since. One
// thread.
class DigestCache {
 public:
  // `progress` grows with every edit that can have changed the session or map.
  std::uint64_t OfSession(const Atlas& atlas, SessionId session, std::uint64_t progress);
  std::uint64_t OfMap(const Atlas& atlas, MapId map, std::uint64_t progress);

 private:
  using Entry = std::pair<std::uint64_t, std::uint64_t>;  // progress, digest
  std::map<SessionId, Entry> sessions_;
  std::map<MapId, Entry> maps_;
};

// What the status says beside the service's state.
struct ServerFacts {
  std::string site;
  std::string store_path;
  std::uint64_t incarnation = 0;
  double uptime_seconds = 0.0;
  std::size_t queued = 0;
  std::size_t queue_capacity = 0;
  SnapshotReport snapshot;
  // What the server does with maps by itself; none where that is disabled.
  struct Work {
    WorkReport report;
    std::uint64_t vocabulary = 0;  // fingerprint
  };
  std::optional<Work> work = {};
};

// The JSON text of the status topic. Ids are text (64 bits do not fit JSON numbers); sessions and maps whose agents are
// gone carry their digest.
std::string StatusJson(const ServiceState& state, const ServerFacts& facts, DigestCache& digests);

}  // namespace pangaea
