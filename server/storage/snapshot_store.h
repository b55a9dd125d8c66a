#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <stop_token>
#include <utility>
#include <vector>

#include "common/base/result.h"
#include "common/map/atlas.h"
#include "server/storage/database.h"

namespace pangaea {

// Writes a snapshot's row and pieces, without its keyframes' data. Within a transaction of the caller's, or without
// one: then it counts from its last step on.
Status InsertSnapshot(Database& database, const Atlas& atlas, std::uint64_t position, bool kept,
                      std::int64_t now_unix_ns, const std::stop_token& stop);

// How far back undo reaches: a snapshot from before each merge is kept, and the journal since the oldest of them.
struct SnapshotRetention {
  // Snapshots kept, the newest. Each costs about as much as 300 bytes a landmark and keyframe.
  std::size_t snapshots = 4;
  // Journal after the oldest of them, bytes: the older ones are given up when it grows beyond.
  std::uint64_t journal_bytes = 512U << 20;
};

// Writes snapshots of the atlas beside a store that another thread appends to, over a connection of its own and in
// short transactions, so that appending never waits for long. One thread at a time.
class SnapshotStore {
 public:
  // `path` is a store that Store::Open made or checked.
  static Result<SnapshotStore> Open(const std::filesystem::path& path, std::uint64_t max_bytes,
                                    const SnapshotRetention& retention = {});

  // Makes `atlas`, which is the state after all edits up to `position`, what recovery starts from, and removes what it
  // replaces and undo does not need: journaled edits up to `position`, older snapshots, data of keyframes that are
  // gone. Interrupted at any instant (by `stop`, an error, or the death of the process), the store stays as good as
  // before.
  Status Write(const Atlas& atlas, std::uint64_t position, std::int64_t now_unix_ns, const std::stop_token& stop);
  // Keeps `atlas` beside it. Not after a Write of a later position: that one may have removed what is after this.
  Status Keep(const Atlas& atlas, std::uint64_t position, std::int64_t now_unix_ns, const std::stop_token& stop);
  // Stores the data of the atlas's keyframes that is not stored yet: what any snapshot of it needs.
  Status StorePayloads(const Atlas& atlas, const std::stop_token& stop);

 private:
  SnapshotStore(Database database, const SnapshotRetention& retention)
      : retention_(retention), database_(std::make_unique<Database>(std::move(database))) {}

  Status LoadStoredPayloads();
  Status StorePayloadBatch(const std::vector<const Keyframe*>& batch);
  // Gives kept snapshots up, the oldest first, until the rest is within what is to be retained.
  Status ReleaseKept(const std::stop_token& stop);
  // Where the oldest snapshot stands: the journal before it serves nothing.
  Result<std::uint64_t> Floor();
  Status RemoveReplaced(std::uint64_t position, const std::stop_token& stop);
  // Data that the newest snapshot does not need goes once no kept one needs it.
  Status RemoveStalePayloads(const Atlas& atlas, std::uint64_t position, const std::stop_token& stop);

  SnapshotRetention retention_;
  std::unique_ptr<Database> database_;
  // Of each stored payload the position of the first snapshot without its keyframe; 0: the newest has it.
  std::map<KeyframeId, std::uint64_t> stored_payloads_;
};

}  // namespace pangaea
