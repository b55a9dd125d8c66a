#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/truth.h"
#include "common/base/result.h"
#include "common/evaluation/absolute_error.h"
#include "common/evaluation/evaluation_report.h"
#include "common/map/ids.h"
#include "server/storage/recovery.h"

namespace pangaea {

// The part of one map that one session built.
struct SessionPart {
  SessionId session = 0;
  MapId map;
  std::optional<std::size_t> truth;  // index of the one that fits the session
  // Every tracked frame's body pose, through the reference keyframes. `truth` of it is empty where none is known.
  EvaluatedTrajectory trajectory;
  MapCounts counts;
};

// The maps of a store, with what their sessions did in them.
struct StoredAtlas {
  std::string site;
  RecoveredAtlas recovered;
  std::vector<MapId> maps;           // the largest first
  std::vector<SessionPart> parts;    // in the order of `maps`, within a map as the sessions joined
  std::vector<WorkTime> work_times;  // of the servers that worked on it
  std::vector<std::string> remarks;  // what a person should know: sessions without truth, truths without session

  const Atlas& atlas() const { return recovered.atlas; }
};

// Reads a store, while a server works on it or not. Errors as Store::OpenReadOnly and RecoverAtlas.
Result<StoredAtlas> ReadStoredAtlas(const std::filesystem::path& store);

// Finds each session's truth: the one of its name, else the only one whose time it shares. kInvalidArgument where
// several fit, or where the one of its name was recorded at another time.
Status AttachTruths(std::span<const Truth> truths, StoredAtlas& stored);

// From now on the left cameras' positions count, not the bodies'.
void EvaluateCameras(StoredAtlas& stored);

}  // namespace pangaea
