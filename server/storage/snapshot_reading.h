#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
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

inline constexpr std::uint64_t kAnyPosition = std::numeric_limits<std::int64_t>::max();

// The newest whole snapshot of a position up to `up_to`; nothing where there is none. kCorrupt where its checksum does
// not fit.
Result<std::optional<StoredSnapshot>> LoadSnapshot(Database& database, std::uint64_t up_to = kAnyPosition);
// Reads keyframe data as a snapshot needs it. Refers to `database`.
Result<KeyframeDataSource> StoredKeyframeData(Database& database);

}  // namespace pangaea
