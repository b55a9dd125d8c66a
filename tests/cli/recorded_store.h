#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/map/ids.h"

namespace pangaea::testing {

// A session that tracked every frame of the EuRoC recording of tests/sensor/recording.h without any error: keyframes at
// its first and its middle frame, the others relative to those.
struct RecordedSession {
  SessionId id = 1;
  std::string name;
  // Builds on the map of this session, in its frame; 0: a map of its own, with its first camera as origin.
  SessionId in_map_of = 0;
  std::int64_t delay_ns = 0;  // added to all stamps: a recording of another time
  bool joined_only = false;   // killed before anything of it came
};

// A store of site "hall" as a server leaves it.
void WriteStore(const std::filesystem::path& path, const std::vector<RecordedSession>& sessions);

}  // namespace pangaea::testing
