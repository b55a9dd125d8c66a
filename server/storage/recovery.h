#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "common/base/result.h"
#include "common/map/atlas.h"
#include "server/ingest/journal.h"
#include "server/storage/store.h"

namespace pangaea {

// Everything a store knows, as of its last commit.
struct RecoveredAtlas {
  Atlas atlas;
  std::vector<SessionRecord> sessions;  // in the order they joined
  std::vector<JournaledRejection> rejections;
  std::vector<std::pair<MapId, MapId>> separations;  // see Store::Separations
  std::uint64_t position = 0;                        // of the newest edits
  std::uint64_t correction = 0;                      // of the newest edits of the server's own that are known of
  std::uint64_t snapshot_position = 0;               // what the snapshot it started from holds; 0 where there was none
  std::uint64_t replayed = 0;                        // entries of the journal applied on top of it
};

// The newest snapshot and the journal after it. kCorrupt where they contradict each other or themselves.
Result<RecoveredAtlas> RecoverAtlas(Store& store);

}  // namespace pangaea
