#include "server/storage/snapshot_reading.h"

#include <memory>
#include <string>
#include <utility>

#include "common/base/bytes.h"
#include "common/base/hash.h"

namespace pangaea {
namespace {

Result<std::vector<std::byte>> LoadChunks(Database& database, std::uint64_t snapshot, std::size_t bytes) {
  auto select = Statement::Prepare(database, "SELECT bytes FROM snapshot_chunks WHERE snapshot = ?1 ORDER BY chunk");
  if (!select) return tl::make_unexpected(select.error());
  select->Bind(snapshot);
  std::vector<std::byte> atlas;
  atlas.reserve(bytes);
  for (auto row = select->Step(); !row || *row; row = select->Step()) {
    if (!row) return tl::make_unexpected(row.error());
    const auto chunk = select->Blob(0);
    atlas.insert(atlas.end(), chunk.begin(), chunk.end());
  }
  return atlas;
}

Result<std::shared_ptr<const KeyframeData>> LoadKeyframeData(Statement& select, const std::string& path,
                                                             KeyframeId id) {
  select.Reset();
  const auto row = select.Bind(id.session).Bind(id.counter).Step();
  if (!row) return tl::make_unexpected(row.error());
  if (!*row) return Fail(ErrorCode::kCorrupt, path + ": the data of keyframe " + ToString(id) + " is missing");
  ByteReader reader(select.Blob(0));
  return DecodeKeyframeData(reader);
}

}  // namespace

Result<std::optional<StoredSnapshot>> LoadSnapshot(Database& database, std::uint64_t up_to) {
  auto select = Statement::Prepare(database,
                                   "SELECT id, position, bytes, checksum FROM snapshots WHERE position <= ?1 ORDER BY "
                                   "position DESC, id DESC LIMIT 1");
  if (!select) return tl::make_unexpected(select.error());
  const auto row = select->Bind(up_to).Step();
  if (!row) return tl::make_unexpected(row.error());
  if (!*row) return std::nullopt;
  auto atlas = LoadChunks(database, select->Word(0), select->Word(2));
  if (!atlas) return tl::make_unexpected(atlas.error());
  if (Hash64(*atlas) != select->Word(3)) {
    return Fail(ErrorCode::kCorrupt, database.path().string() + ": the snapshot of the atlas is damaged");
  }
  return StoredSnapshot{select->Word(1), std::move(*atlas)};
}

Result<KeyframeDataSource> StoredKeyframeData(Database& database) {
  auto select = Statement::Prepare(database, "SELECT bytes FROM keyframe_payloads WHERE session = ?1 AND counter = ?2");
  if (!select) return tl::make_unexpected(select.error());
  // std::function wants to be copied, a statement does not.
  auto shared = std::make_shared<Statement>(std::move(*select));
  return [shared, path = database.path().string()](KeyframeId id) { return LoadKeyframeData(*shared, path, id); };
}

}  // namespace pangaea
