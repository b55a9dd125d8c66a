#include "server/storage/snapshot_store.h"

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "common/base/bytes.h"
#include "common/base/hash.h"
#include "common/map/atlas_codec.h"
#include "server/storage/store.h"

namespace pangaea {
namespace {

// Sizes of a transaction: about 1 MB, a few milliseconds for which an append may have to wait.
constexpr std::size_t kPayloadsPerTransaction = 16;
constexpr std::size_t kChunkBytes = 1U << 20;
constexpr int kRowsPerDeletion = 16;

Status Stopped() { return Fail(ErrorCode::kUnavailable, "the snapshot was given up because the server stops"); }

// Repeats a DELETE with a LIMIT inside until it finds nothing more, a transaction each.
Status DeleteInSteps(Database& database, const std::string& sql, std::uint64_t parameter, const std::stop_token& stop) {
  auto remove = Statement::Prepare(database, sql.c_str());
  if (!remove) return tl::make_unexpected(remove.error());
  do {
    if (stop.stop_requested()) return Stopped();
    if (auto status = remove->Bind(parameter).Run(); !status) return status;
  } while (database.ChangedRows() > 0);
  return {};
}

std::string DeleteSome(const std::string& table, const std::string& condition) {
  return "DELETE FROM " + table + " WHERE rowid IN (SELECT rowid FROM " + table + " WHERE " + condition + " LIMIT " +
         std::to_string(kRowsPerDeletion) + ")";
}

Status StoreChunks(Database& database, std::int64_t snapshot, std::span<const std::byte> bytes,
                   const std::stop_token& stop) {
  auto insert = Statement::Prepare(database, "INSERT INTO snapshot_chunks VALUES(?1, ?2, ?3)");
  if (!insert) return tl::make_unexpected(insert.error());
  for (std::size_t begin = 0; begin < bytes.size(); begin += kChunkBytes) {
    if (stop.stop_requested()) return Stopped();
    const auto chunk = bytes.subspan(begin, std::min(kChunkBytes, bytes.size() - begin));
    if (auto status = insert->Bind(snapshot).Bind(begin / kChunkBytes).Bind(chunk).Run(); !status) return status;
  }
  return {};
}

}  // namespace

Status InsertSnapshot(Database& database, const Atlas& atlas, std::uint64_t position, bool kept,
                      std::int64_t now_unix_ns, const std::stop_token& stop) {
  const std::vector<std::byte> bytes = EncodeAtlas(atlas);
  // Above the chunks that an interrupted snapshot may have left behind, too.
  const auto newest = database.Number(
      "SELECT max(coalesce((SELECT max(id) FROM snapshots), 0), coalesce((SELECT max(snapshot) FROM snapshot_chunks), "
      "0))");
  if (!newest) return tl::make_unexpected(newest.error());
  const std::int64_t snapshot = *newest + 1;
  if (auto status = StoreChunks(database, snapshot, bytes, stop); !status) return status;
  auto insert = Statement::Prepare(database, "INSERT INTO snapshots VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)");
  if (!insert) return tl::make_unexpected(insert.error());
  insert->Bind(snapshot).Bind(position).Bind(atlas.version()).Bind(now_unix_ns);
  insert->Bind((bytes.size() + kChunkBytes - 1) / kChunkBytes).Bind(bytes.size()).Bind(Hash64(bytes));
  return insert->Bind(static_cast<std::uint32_t>(kept)).Run();
}

Result<SnapshotStore> SnapshotStore::Open(const std::filesystem::path& path, std::uint64_t max_bytes,
                                          const SnapshotRetention& retention) {
  auto database = Database::Open(path, Database::Access::kReadWrite);
  if (!database) return tl::make_unexpected(database.error());
  if (auto status = ConfigureForWriting(*database, max_bytes); !status) return tl::make_unexpected(status.error());
  // NORMAL: a power cut may take a snapshot's last steps back, but always the last ones first, and they can be redone.
  if (auto status = database->Execute("PRAGMA synchronous=NORMAL"); !status) return tl::make_unexpected(status.error());
  SnapshotStore store(std::move(*database), retention);
  if (auto status = store.LoadStoredPayloads(); !status) return tl::make_unexpected(status.error());
  return store;
}

Status SnapshotStore::Write(const Atlas& atlas, std::uint64_t position, std::int64_t now_unix_ns,
                            const std::stop_token& stop) {
  if (auto status = StorePayloads(atlas, stop); !status) return status;
  if (auto status = InsertSnapshot(*database_, atlas, position, false, now_unix_ns, stop); !status) return status;
  if (auto status = ReleaseKept(stop); !status) return status;
  if (auto status = RemoveReplaced(position, stop); !status) return status;
  return RemoveStalePayloads(atlas, position, stop);
}

Status SnapshotStore::Keep(const Atlas& atlas, std::uint64_t position, std::int64_t now_unix_ns,
                           const std::stop_token& stop) {
  if (retention_.snapshots == 0) return {};
  if (auto status = StorePayloads(atlas, stop); !status) return status;
  if (auto status = InsertSnapshot(*database_, atlas, position, true, now_unix_ns, stop); !status) return status;
  return ReleaseKept(stop);
}

Status SnapshotStore::LoadStoredPayloads() {
  auto select = Statement::Prepare(*database_, "SELECT session, counter, missing_since FROM keyframe_payloads");
  if (!select) return tl::make_unexpected(select.error());
  for (auto row = select->Step(); !row || *row; row = select->Step()) {
    if (!row) return tl::make_unexpected(row.error());
    const KeyframeId id{select->Word(0), static_cast<std::uint32_t>(select->Word(1))};
    stored_payloads_.emplace(id, select->Word(2));
  }
  return {};
}

Status SnapshotStore::StorePayloads(const Atlas& atlas, const std::stop_token& stop) {
  std::vector<const Keyframe*> missing;
  atlas.ForEachKeyframe([&](const Keyframe& keyframe) {
    if (!stored_payloads_.contains(keyframe.id)) missing.push_back(&keyframe);
  });
  for (std::size_t begin = 0; begin < missing.size(); begin += kPayloadsPerTransaction) {
    if (stop.stop_requested()) return Stopped();
    const std::size_t end = std::min(begin + kPayloadsPerTransaction, missing.size());
    const std::vector<const Keyframe*> batch(missing.begin() + static_cast<std::ptrdiff_t>(begin),
                                             missing.begin() + static_cast<std::ptrdiff_t>(end));
    if (auto status = StorePayloadBatch(batch); !status) return status;
  }
  return {};
}

Status SnapshotStore::StorePayloadBatch(const std::vector<const Keyframe*>& batch) {
  auto transaction = Transaction::Begin(*database_);
  if (!transaction) return tl::make_unexpected(transaction.error());
  auto insert = Statement::Prepare(*database_, "INSERT OR IGNORE INTO keyframe_payloads VALUES(?1, ?2, ?3, 0)");
  if (!insert) return tl::make_unexpected(insert.error());
  for (const Keyframe* keyframe : batch) {
    ByteWriter writer;
    EncodeKeyframeData(*keyframe->data, writer);
    insert->Bind(keyframe->id.session).Bind(keyframe->id.counter).Bind(writer.bytes());
    if (auto status = insert->Run(); !status) return status;
  }
  if (auto status = transaction->Commit(); !status) return status;
  for (const Keyframe* keyframe : batch) stored_payloads_.emplace(keyframe->id, 0);
  return {};
}

Status SnapshotStore::ReleaseKept(const std::stop_token& stop) {
  const auto kept = database_->Number("SELECT count(*) FROM snapshots WHERE kept");
  if (!kept) return tl::make_unexpected(kept.error());
  for (auto count = static_cast<std::uint64_t>(*kept); count > 0; --count) {
    if (stop.stop_requested()) return Stopped();
    const auto bytes = database_->Number(
        "SELECT sum(length(edits)) FROM envelopes WHERE position > (SELECT min(position) FROM snapshots WHERE kept)");
    if (!bytes) return tl::make_unexpected(bytes.error());
    if (count <= retention_.snapshots && static_cast<std::uint64_t>(*bytes) <= retention_.journal_bytes) return {};
    const Status released = database_->Execute(
        "DELETE FROM snapshots WHERE id = (SELECT id FROM snapshots WHERE kept ORDER BY position, id LIMIT 1)");
    if (!released) return released;
  }
  return {};
}

Result<std::uint64_t> SnapshotStore::Floor() {
  return database_->Number("SELECT min(position) FROM snapshots").map([](std::int64_t position) {
    return static_cast<std::uint64_t>(position);
  });
}

Status SnapshotStore::RemoveReplaced(std::uint64_t position, const std::stop_token& stop) {
  // An older snapshot goes before the journal that follows it: recovery never finds one with a gap after it.
  const std::string replaced =
      "(position < ?1 AND NOT kept) OR (position = ?1 AND NOT kept AND id < (SELECT max(id) FROM snapshots))";
  if (auto status = DeleteInSteps(*database_, DeleteSome("snapshots", replaced), position, stop); !status) {
    return status;
  }
  const auto floor = Floor();
  if (!floor) return tl::make_unexpected(floor.error());
  for (const char* table : {"envelopes", "server_edits"}) {
    if (auto status = DeleteInSteps(*database_, DeleteSome(table, "rowid <= ?1"), *floor, stop); !status) {
      return status;
    }
  }
  const std::string orphaned = "snapshot NOT IN (SELECT id FROM snapshots) AND ?1 = ?1";
  return DeleteInSteps(*database_, DeleteSome("snapshot_chunks", orphaned), 0, stop);
}

Status SnapshotStore::RemoveStalePayloads(const Atlas& atlas, std::uint64_t position, const std::stop_token& stop) {
  const auto floor = Floor();
  if (!floor) return tl::make_unexpected(floor.error());
  auto mark = Statement::Prepare(*database_,
                                 "UPDATE keyframe_payloads SET missing_since = ?3 WHERE session = ?1 AND counter = ?2");
  if (!mark) return tl::make_unexpected(mark.error());
  auto remove = Statement::Prepare(*database_, "DELETE FROM keyframe_payloads WHERE session = ?1 AND counter = ?2");
  if (!remove) return tl::make_unexpected(remove.error());
  for (auto payload = stored_payloads_.begin(); payload != stored_payloads_.end();) {
    if (stop.stop_requested()) return Stopped();
    auto& [id, missing_since] = *payload;
    const bool missing = atlas.FindKeyframe(id) == nullptr;
    if (missing && (missing_since == 0 ? position : missing_since) <= *floor) {
      if (auto status = remove->Bind(id.session).Bind(id.counter).Run(); !status) return status;
      payload = stored_payloads_.erase(payload);
      continue;
    }
    if (missing != (missing_since != 0)) {
      missing_since = missing ? position : 0;
      if (auto status = mark->Bind(id.session).Bind(id.counter).Bind(missing_since).Run(); !status) return status;
    }
    ++payload;
  }
  return {};
}

}  // namespace pangaea
