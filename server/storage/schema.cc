#include "server/storage/schema.h"

namespace pangaea {
namespace {

// "PNGA": tells our stores from other SQLite files, to us and to file(1).
constexpr std::int64_t kApplicationId = 0x504e4741;

// Positions number both streams of edits together, in the order in which they were applied. Ids and checksums are
// words of 64 bits without sign, stored as the signed integers with the same bits.
constexpr const char* kTables = R"(
CREATE TABLE meta(key TEXT PRIMARY KEY NOT NULL, value NOT NULL) WITHOUT ROWID;
CREATE TABLE sessions(
  id INTEGER PRIMARY KEY,
  name TEXT NOT NULL,
  software TEXT NOT NULL,
  wire_version INTEGER NOT NULL,
  sensor_kind INTEGER NOT NULL,
  rig BLOB NOT NULL,
  epoch_ns INTEGER NOT NULL,
  closed INTEGER NOT NULL,
  joined_unix_ns INTEGER NOT NULL,
  acknowledged INTEGER NOT NULL,
  rejected INTEGER NOT NULL);
CREATE TABLE envelopes(
  position INTEGER PRIMARY KEY,
  session INTEGER NOT NULL,
  sequence INTEGER NOT NULL,
  base_correction_version INTEGER NOT NULL,
  wire_version INTEGER NOT NULL,
  checksum INTEGER NOT NULL,
  edits BLOB NOT NULL,
  UNIQUE(session, sequence));
CREATE TABLE server_edits(
  position INTEGER PRIMARY KEY,
  cause TEXT NOT NULL,
  wire_version INTEGER NOT NULL,
  edits BLOB NOT NULL,
  undone INTEGER NOT NULL DEFAULT 0);
CREATE TABLE rejections(
  session INTEGER NOT NULL,
  sequence INTEGER NOT NULL,
  reason INTEGER NOT NULL,
  text TEXT NOT NULL,
  PRIMARY KEY(session, sequence)) WITHOUT ROWID;
CREATE TABLE snapshots(
  id INTEGER PRIMARY KEY,
  position INTEGER NOT NULL,
  atlas_version INTEGER NOT NULL,
  created_unix_ns INTEGER NOT NULL,
  chunks INTEGER NOT NULL,
  bytes INTEGER NOT NULL,
  checksum INTEGER NOT NULL,
  kept INTEGER NOT NULL DEFAULT 0);
CREATE TABLE snapshot_chunks(
  snapshot INTEGER NOT NULL,
  chunk INTEGER NOT NULL,
  bytes BLOB NOT NULL,
  PRIMARY KEY(snapshot, chunk));
CREATE TABLE keyframe_payloads(
  session INTEGER NOT NULL,
  counter INTEGER NOT NULL,
  bytes BLOB NOT NULL,
  missing_since INTEGER NOT NULL DEFAULT 0,
  PRIMARY KEY(session, counter));
CREATE TABLE separations(
  cause TEXT NOT NULL,
  first_session INTEGER NOT NULL,
  first_counter INTEGER NOT NULL,
  second_session INTEGER NOT NULL,
  second_counter INTEGER NOT NULL);
CREATE TABLE work_times(
  kind TEXT NOT NULL,
  wall_us INTEGER NOT NULL,
  cpu_us INTEGER NOT NULL,
  unix_ns INTEGER NOT NULL);
)";

// From schema 1: what undo needs.
constexpr const char* kUpgradeFrom1 = R"(
ALTER TABLE server_edits ADD COLUMN undone INTEGER NOT NULL DEFAULT 0;
ALTER TABLE snapshots ADD COLUMN kept INTEGER NOT NULL DEFAULT 0;
ALTER TABLE keyframe_payloads ADD COLUMN missing_since INTEGER NOT NULL DEFAULT 0;
CREATE TABLE separations(
  cause TEXT NOT NULL,
  first_session INTEGER NOT NULL,
  first_counter INTEGER NOT NULL,
  second_session INTEGER NOT NULL,
  second_counter INTEGER NOT NULL);
PRAGMA user_version=2;
)";

// From schema 2: the times of the server's work.
constexpr const char* kUpgradeFrom2 = R"(
CREATE TABLE work_times(
  kind TEXT NOT NULL,
  wall_us INTEGER NOT NULL,
  cpu_us INTEGER NOT NULL,
  unix_ns INTEGER NOT NULL);
PRAGMA user_version=3;
)";

Status WriteIdentity(Database& database, const std::string& site) {
  const std::string identity = "PRAGMA application_id=" + std::to_string(kApplicationId) +
                               "; PRAGMA user_version=" + std::to_string(kStoreSchema);
  if (auto status = database.Execute(identity.c_str()); !status) return status;
  auto insert = Statement::Prepare(database, "INSERT INTO meta VALUES('site', ?1), ('incarnation', 0)");
  if (!insert) return tl::make_unexpected(insert.error());
  return insert->Bind(std::string_view(site)).Run();
}

}  // namespace

Status CreateSchema(Database& database, const std::string& site) {
  auto transaction = Transaction::Begin(database);
  if (!transaction) return tl::make_unexpected(transaction.error());
  if (auto status = database.Execute(kTables); !status) return status;
  if (auto status = WriteIdentity(database, site); !status) return status;
  return transaction->Commit();
}

Status CheckSchema(Database& database) {
  const auto application = database.Number("PRAGMA application_id");
  if (!application) return tl::make_unexpected(application.error());
  if (*application != kApplicationId) {
    return Fail(ErrorCode::kCorrupt, database.path().string() + ": is an SQLite file, but not the store of an atlas");
  }
  const auto schema = database.Number("PRAGMA user_version");
  if (!schema) return tl::make_unexpected(schema.error());
  if (*schema >= kOldestStoreSchema && *schema <= kStoreSchema) return {};
  return Fail(ErrorCode::kUnsupported, database.path().string() + ": has store schema " + std::to_string(*schema) +
                                           ", this build reads schemas " + std::to_string(kOldestStoreSchema) + " to " +
                                           std::to_string(kStoreSchema));
}

Status UpgradeSchema(Database& database) {
  const auto schema = database.Number("PRAGMA user_version");
  if (!schema) return tl::make_unexpected(schema.error());
  if (*schema == kStoreSchema) return {};
  auto transaction = Transaction::Begin(database);
  if (!transaction) return tl::make_unexpected(transaction.error());
  if (*schema < 2) {
    if (auto status = database.Execute(kUpgradeFrom1); !status) return status;
  }
  if (auto status = database.Execute(kUpgradeFrom2); !status) return status;
  return transaction->Commit();
}

Result<std::string> StoredSite(Database& database) {
  auto select = Statement::Prepare(database, "SELECT value FROM meta WHERE key = 'site'");
  if (!select) return tl::make_unexpected(select.error());
  const auto row = select->Step();
  if (!row) return tl::make_unexpected(row.error());
  if (!*row) return Fail(ErrorCode::kCorrupt, database.path().string() + ": has no site");
  return select->Text(0);
}

Result<bool> IsEmpty(Database& database) {
  return database.Number("SELECT count(*) FROM sqlite_schema").map([](std::int64_t tables) { return tables == 0; });
}

}  // namespace pangaea
