#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/base/result.h"
#include "server/ingest/journal.h"
#include "server/storage/database.h"
#include "server/storage/file_lock.h"

namespace pangaea {

struct StoreOptions {
  // Quota of the database file, bytes; 0 is none. A store at its quota behaves like one on a full disk.
  std::uint64_t max_bytes = 0;

  Status Check() const;
};

struct StoreSize {
  std::uint64_t bytes = 0;  // on disk, with the write-ahead log
  std::uint64_t journaled_envelopes = 0;
};

// The durable side of an atlas: one SQLite file (write-ahead log, synchronous FULL: a commit survives a power cut).
// One object belongs to one thread at a time. While a server has the store open, others may OpenReadOnly it.
class Store {
 public:
  // Creates the file where there is none. Errors: kRefused for the store of another site, kUnsupported for another
  // schema, kCorrupt for a file that is no store, kUnavailable when another server has it open or it cannot be read.
  static Result<Store> Open(const std::filesystem::path& path, const std::string& site, const StoreOptions& options);
  static Result<Store> OpenReadOnly(const std::filesystem::path& path);

  const std::string& site() const { return site_; }
  // Counts one more start of a server on this store: agents see from the number in the acks that it restarted.
  Result<std::uint64_t> BeginIncarnation();

  // One transaction. kUnavailable when the disk (or the quota) is full: nothing of the batch was stored.
  Status Append(const JournalBatch& batch);
  // A part of Append, within a transaction of the caller's.
  Status AppendServerEdits(const std::vector<ServerEdits>& server_edits);
  // Whether the store takes writes at the moment.
  Status Probe();

  Result<std::vector<SessionRecord>> Sessions();
  Result<std::vector<JournaledRejection>> Rejections();
  // Pairs of maps that an operator took apart: they are not to be merged again. None in a store of schema 1.
  Result<std::vector<std::pair<MapId, MapId>>> Separations();
  // How long the server's work took, in the order in which it ended; of all its runs. None in a store before schema 3.
  Result<std::vector<WorkTime>> WorkTimes();
  // Both streams of edits with a position > `position`, in order: envelopes, and the server's own edits as envelopes of
  // session 0. Stops at the first failure of `visit`, and returns it.
  Status ForEachEditsAfter(std::uint64_t position, const std::function<Status(const JournalEntry&)>& visit);

  StoreSize Size();
  Status SetMaxBytes(std::uint64_t max_bytes);
  const std::filesystem::path& path() const { return database_->path(); }
  Database& database() { return *database_; }

 private:
  Store(std::unique_ptr<Database> database, std::string site, std::unique_ptr<FileLock> lock);
  Status AppendEntries(const std::vector<JournalEntry>& entries);
  Status AppendRejections(const std::vector<JournaledRejection>& rejections);
  Status UpdateSessions(const std::vector<SessionRecord>& sessions);
  Status AppendWorkTimes(const std::vector<WorkTime>& times);

  // Declared before the database: the connection is closed first. None when read-only.
  std::unique_ptr<FileLock> lock_;
  std::unique_ptr<Database> database_;  // by pointer: transactions refer to it while the store may move
  std::string site_;
};

// Settings of a connection that writes: write-ahead log and the quota.
Status ConfigureForWriting(Database& database, std::uint64_t max_bytes);

}  // namespace pangaea
