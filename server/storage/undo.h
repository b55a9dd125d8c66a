#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "common/base/result.h"
#include "common/map/ids.h"
#include "server/storage/store.h"

namespace pangaea {

// Edits of the server's own that are in the journal, with one cause.
struct JournaledCause {
  std::string cause;
  std::uint64_t position = 0;  // of the first of them
  std::uint64_t entries = 0;
  bool undone = false;
  bool reachable = false;  // a snapshot from before it is there, with all of the journal since
};
// Ascending by position.
Result<std::vector<JournaledCause>> ListCauses(Store& store);

struct UndoReport {
  std::uint64_t position = 0;                        // the journal's, of the undoing itself
  std::vector<std::string> also;                     // causes that built on it and were taken back with it
  std::vector<std::pair<MapId, MapId>> separations;  // maps that are not to be merged again
  std::size_t misfits = 0;                           // edits of agents that made no sense without it
};

// For people: what was done.
std::string Describe(const std::string& cause, const UndoReport& report);

// Takes a cause back: rebuilds the atlas from the newest snapshot before it and from the journal without its edits, and
// makes that what recovery starts from. All or nothing. No server may have the store open (the caller's Store::Open saw
// to that). kNotFound for a cause that is not in the journal, kRefused where it was undone already, or where the
// journal since any snapshot before it is gone.
Result<UndoReport> UndoCause(Store& store, const std::string& cause, std::int64_t now_unix_ns);

}  // namespace pangaea
