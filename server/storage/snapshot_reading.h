#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/base/result.h"
#include "common/map/atlas_codec.h"
#include "server/storage/database.h"

namespace pangaea {

// A snapshot as it stands in the store.
struct StoredSnapshot {
  std::uint64_t position = 0;
  std::vector<std::byte> atlas;  // EncodeAtlas()
};

// The newest whole snapshot; nothing before the first. kCorrupt where its checksum does not fit.
Result<std::optional<StoredSnapshot>> LoadSnapshot(Database& database);
// Reads keyframe data as a snapshot needs it. Refers to `database`.
Result<KeyframeDataSource> StoredKeyframeData(Database& database);

}  // namespace pangaea
