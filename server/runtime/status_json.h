#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "server/runtime/atlas_service.h"

namespace pangaea {

// Digests that were asked for before: one is only computed anew when something was acknowledged since. One thread.
class DigestCache {
 public:
  std::uint64_t OfSession(const Atlas& atlas, SessionId session, std::uint64_t acknowledged);
  // `acknowledged`: summed over the sessions of the map.
  std::uint64_t OfMap(const Atlas& atlas, MapId map, std::uint64_t acknowledged);

 private:
  using Entry = std::pair<std::uint64_t, std::uint64_t>;  // acknowledged, digest
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
};

// The JSON text of the status topic. Ids are text (64 bits do not fit JSON numbers); sessions and maps whose agents are
// gone carry their digest.
std::string StatusJson(const ServiceState& state, const ServerFacts& facts, DigestCache& digests);

// Resident memory of this process; 0 where the system does not say.
double ResidentMebibytes();

}  // namespace pangaea
