#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <set>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "common/base/result.h"
#include "common/map/atlas.h"
#include "server/storage/database.h"

namespace pangaea {

// Writes snapshots of the atlas beside a store that another thread appends to, over a connection of its own and in
// short transactions, so that appending never waits for long. One thread at a time.
class SnapshotStore {
 public:
  // `path` is a store that Store::Open made or checked.
  static Result<SnapshotStore> Open(const std::filesystem::path& path, std::uint64_t max_bytes);

  // Makes `atlas`, which is the state after all edits up to `position`, what recovery starts from, and removes what it
  // replaces: journaled edits up to `position`, older snapshots, data of keyframes that are gone. Interrupted at any
  // instant (by `stop`, an error, or the death of the process), the store stays as good as before.
  Status Write(const Atlas& atlas, std::uint64_t position, std::int64_t now_unix_ns, const std::stop_token& stop);

 private:
  explicit SnapshotStore(Database database) : database_(std::make_unique<Database>(std::move(database))) {}

  Status LoadStoredPayloads();
  Status StorePayloads(const Atlas& atlas, const std::stop_token& stop);
  Status StorePayloadBatch(const std::vector<const Keyframe*>& batch);
  Status StoreChunks(std::int64_t snapshot, std::span<const std::byte> bytes, const std::stop_token& stop);
  Status RemoveReplaced(std::int64_t snapshot, std::uint64_t position, const std::stop_token& stop);
  Status RemoveStalePayloads(const Atlas& atlas, const std::stop_token& stop);

  std::unique_ptr<Database> database_;
  std::set<KeyframeId> stored_payloads_;
};

}  // namespace pangaea
