#include "server/storage/store.h"

#include <system_error>
#include <utility>

#include "server/storage/schema.h"
#include "server/storage/session_codec.h"

namespace pangaea {
namespace {

// A quota below this cannot hold the empty tables.
constexpr std::uint64_t kSmallestQuota = 1U << 20;

std::uint64_t FileBytes(const std::filesystem::path& path) {
  std::error_code error;
  const auto bytes = std::filesystem::file_size(path, error);
  return error ? 0 : bytes;
}

Status CheckSite(Database& database, const std::string& site) {
  const auto stored = StoredSite(database);
  if (!stored) return tl::make_unexpected(stored.error());
  if (*stored == site) return {};
  return Fail(ErrorCode::kRefused,
              database.path().string() + ": holds the atlas of site '" + *stored + "', not of site '" + site + "'");
}

Status CreateOrCheck(Database& database, const std::string& site) {
  const auto empty = IsEmpty(database);
  if (!empty) return tl::make_unexpected(empty.error());
  if (*empty) return CreateSchema(database, site);
  if (auto status = CheckSchema(database); !status) return status;
  if (auto status = CheckSite(database, site); !status) return status;
  return UpgradeSchema(database);
}

// A row of the query in Store::Sessions().
Result<SessionRecord> ReadSession(const Statement& row, const std::string& site) {
  SessionRecord record;
  SessionAnnouncement& session = record.announcement;
  session.session = row.Word(0);
  session.name = row.Text(1);
  session.site = site;
  session.software_version = row.Text(2);
  session.wire_version = static_cast<std::uint32_t>(row.Word(3));
  session.sensor_kind = static_cast<SensorKind>(row.Word(4));
  if (auto status = DecodeRig(row.Blob(5), session); !status) return tl::make_unexpected(status.error());
  session.epoch_ns = row.Number(6);
  session.closed = row.Number(7) != 0;
  record.joined_unix_ns = row.Number(8);
  record.acknowledged = row.Word(9);
  record.rejected = row.Word(10);
  return record;
}

}  // namespace

Status StoreOptions::Check() const {
  if (max_bytes == 0 || max_bytes >= kSmallestQuota) return {};
  return Fail(ErrorCode::kInvalidArgument, "the store's quota is " + std::to_string(max_bytes) +
                                               " bytes; allowed are 0 (none) and " + std::to_string(kSmallestQuota) +
                                               " or more");
}

Status ConfigureForWriting(Database& database, std::uint64_t max_bytes) {
  // The write-ahead log shrinks to 64 MB after a burst. FULL: a commit survives a power cut.
  constexpr const char* kSettings =
      "PRAGMA journal_mode=WAL; PRAGMA synchronous=FULL; PRAGMA journal_size_limit=67108864";
  if (auto status = database.Execute(kSettings); !status) return status;
  const auto page_bytes = database.Number("PRAGMA page_size");
  if (!page_bytes) return tl::make_unexpected(page_bytes.error());
  // SQLite's own upper limit stands for "no quota".
  constexpr std::uint64_t kMostPages = 4294967294;
  const std::uint64_t pages = max_bytes == 0 ? kMostPages : max_bytes / static_cast<std::uint64_t>(*page_bytes);
  return database.Execute(("PRAGMA max_page_count=" + std::to_string(pages)).c_str());
}

Store::Store(std::unique_ptr<Database> database, std::string site, std::unique_ptr<FileLock> lock)
    : lock_(std::move(lock)), database_(std::move(database)), site_(std::move(site)) {}

Result<Store> Store::Open(const std::filesystem::path& path, const std::string& site, const StoreOptions& options) {
  if (auto status = options.Check(); !status) return tl::make_unexpected(status.error());
  auto lock = FileLock::Take(path.string() + ".lock");
  if (!lock) return tl::make_unexpected(lock.error());
  auto database = Database::Open(path, Database::Access::kReadWrite);
  if (!database) return tl::make_unexpected(database.error());
  if (auto status = ConfigureForWriting(*database, options.max_bytes); !status) {
    return tl::make_unexpected(status.error());
  }
  if (auto status = CreateOrCheck(*database, site); !status) return tl::make_unexpected(status.error());
  return Store(std::make_unique<Database>(std::move(*database)), site, std::make_unique<FileLock>(std::move(*lock)));
}

Result<Store> Store::OpenReadOnly(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return Fail(ErrorCode::kNotFound, path.string() + ": there is no such store");
  auto database = Database::Open(path, Database::Access::kReadOnly);
  if (!database) return tl::make_unexpected(database.error());
  if (auto status = CheckSchema(*database); !status) return tl::make_unexpected(status.error());
  auto site = StoredSite(*database);
  if (!site) return tl::make_unexpected(site.error());
  return Store(std::make_unique<Database>(std::move(*database)), std::move(*site), nullptr);
}

Result<std::uint64_t> Store::BeginIncarnation() {
  auto update = Statement::Prepare(*database_, "UPDATE meta SET value = value + 1 WHERE key = 'incarnation'");
  if (!update) return tl::make_unexpected(update.error());
  if (auto status = update->Run(); !status) return tl::make_unexpected(status.error());
  return database_->Number("SELECT value FROM meta WHERE key = 'incarnation'").map([](std::int64_t number) {
    return static_cast<std::uint64_t>(number);
  });
}

Status Store::Append(const JournalBatch& batch) {
  auto transaction = Transaction::Begin(*database_);
  if (!transaction) return tl::make_unexpected(transaction.error());
  if (auto status = AppendEntries(batch.entries); !status) return status;
  if (auto status = AppendServerEdits(batch.server_edits); !status) return status;
  if (auto status = AppendRejections(batch.rejections); !status) return status;
  if (auto status = UpdateSessions(batch.sessions); !status) return status;
  if (auto status = AppendWorkTimes(batch.work_times); !status) return status;
  return transaction->Commit();
}

Status Store::Probe() { return database_->Execute("UPDATE meta SET value = value WHERE key = 'incarnation'"); }

Status Store::AppendEntries(const std::vector<JournalEntry>& entries) {
  if (entries.empty()) return {};
  auto insert = Statement::Prepare(*database_, "INSERT INTO envelopes VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7)");
  if (!insert) return tl::make_unexpected(insert.error());
  for (const auto& [position, envelope] : entries) {
    insert->Bind(position).Bind(envelope.session).Bind(envelope.sequence).Bind(envelope.base_correction_version);
    insert->Bind(envelope.wire_version).Bind(envelope.checksum).Bind(std::span(envelope.edits));
    if (auto status = insert->Run(); !status) return status;
  }
  return {};
}

Status Store::AppendServerEdits(const std::vector<ServerEdits>& server_edits) {
  if (server_edits.empty()) return {};
  auto insert = Statement::Prepare(*database_, "INSERT INTO server_edits VALUES(?1, ?2, ?3, ?4, 0)");
  if (!insert) return tl::make_unexpected(insert.error());
  for (const auto& [position, cause, edits] : server_edits) {
    insert->Bind(position).Bind(std::string_view(cause)).Bind(kWireVersion).Bind(std::span(edits));
    if (auto status = insert->Run(); !status) return status;
  }
  return {};
}

Status Store::AppendRejections(const std::vector<JournaledRejection>& rejections) {
  if (rejections.empty()) return {};
  auto insert = Statement::Prepare(*database_, "INSERT INTO rejections VALUES(?1, ?2, ?3, ?4)");
  if (!insert) return tl::make_unexpected(insert.error());
  for (const auto& [session, rejection] : rejections) {
    insert->Bind(session).Bind(rejection.sequence).Bind(static_cast<std::uint32_t>(rejection.reason));
    if (auto status = insert->Bind(std::string_view(rejection.text)).Run(); !status) return status;
  }
  return {};
}

Status Store::UpdateSessions(const std::vector<SessionRecord>& sessions) {
  if (sessions.empty()) return {};
  auto upsert = Statement::Prepare(
      *database_, "INSERT OR REPLACE INTO sessions VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11)");
  if (!upsert) return tl::make_unexpected(upsert.error());
  for (const SessionRecord& record : sessions) {
    const SessionAnnouncement& session = record.announcement;
    const std::vector<std::byte> rig = EncodeRig(session);
    upsert->Bind(session.session).Bind(std::string_view(session.name)).Bind(std::string_view(session.software_version));
    upsert->Bind(session.wire_version).Bind(static_cast<std::uint32_t>(session.sensor_kind)).Bind(std::span(rig));
    upsert->Bind(session.epoch_ns).Bind(static_cast<std::uint32_t>(session.closed)).Bind(record.joined_unix_ns);
    if (auto status = upsert->Bind(record.acknowledged).Bind(record.rejected).Run(); !status) return status;
  }
  return {};
}

Status Store::AppendWorkTimes(const std::vector<WorkTime>& times) {
  if (times.empty()) return {};
  auto insert = Statement::Prepare(*database_, "INSERT INTO work_times VALUES(?1, ?2, ?3, ?4)");
  if (!insert) return tl::make_unexpected(insert.error());
  const auto microseconds = [](double milliseconds) { return static_cast<std::int64_t>(1e3 * milliseconds); };
  for (const WorkTime& time : times) {
    insert->Bind(std::string_view(time.kind)).Bind(microseconds(time.wall_ms)).Bind(microseconds(time.cpu_ms));
    if (auto status = insert->Bind(time.unix_ns).Run(); !status) return status;
  }
  return {};
}

Result<std::vector<WorkTime>> Store::WorkTimes() {
  std::vector<WorkTime> times;
  const auto schema = database_->Number("PRAGMA user_version");
  if (!schema) return tl::make_unexpected(schema.error());
  if (*schema < 3) return times;
  auto select = Statement::Prepare(*database_, "SELECT kind, wall_us, cpu_us, unix_ns FROM work_times ORDER BY rowid");
  if (!select) return tl::make_unexpected(select.error());
  const auto milliseconds = [&select](int column) { return 1e-3 * static_cast<double>(select->Number(column)); };
  for (auto row = select->Step(); !row || *row; row = select->Step()) {
    if (!row) return tl::make_unexpected(row.error());
    times.push_back({select->Text(0), milliseconds(1), milliseconds(2), select->Number(3)});
  }
  return times;
}

Result<std::vector<SessionRecord>> Store::Sessions() {
  auto select = Statement::Prepare(*database_, R"(
    SELECT id, name, software, wire_version, sensor_kind, rig, epoch_ns, closed, joined_unix_ns, acknowledged, rejected
    FROM sessions ORDER BY joined_unix_ns, id)");
  if (!select) return tl::make_unexpected(select.error());
  std::vector<SessionRecord> sessions;
  for (auto row = select->Step(); !row || *row; row = select->Step()) {
    if (!row) return tl::make_unexpected(row.error());
    auto record = ReadSession(*select, site_);
    if (!record) return tl::make_unexpected(record.error());
    sessions.push_back(std::move(*record));
  }
  return sessions;
}

Result<std::vector<JournaledRejection>> Store::Rejections() {
  auto select = Statement::Prepare(*database_, "SELECT session, sequence, reason, text FROM rejections ORDER BY 1, 2");
  if (!select) return tl::make_unexpected(select.error());
  std::vector<JournaledRejection> rejections;
  for (auto row = select->Step(); !row || *row; row = select->Step()) {
    if (!row) return tl::make_unexpected(row.error());
    rejections.push_back(
        {select->Word(0), {select->Word(1), static_cast<RejectionReason>(select->Word(2)), select->Text(3)}});
  }
  return rejections;
}

Result<std::vector<std::pair<MapId, MapId>>> Store::Separations() {
  std::vector<std::pair<MapId, MapId>> separations;
  const auto schema = database_->Number("PRAGMA user_version");
  if (!schema) return tl::make_unexpected(schema.error());
  if (*schema < 2) return separations;
  auto select = Statement::Prepare(
      *database_, "SELECT first_session, first_counter, second_session, second_counter FROM separations");
  if (!select) return tl::make_unexpected(select.error());
  for (auto row = select->Step(); !row || *row; row = select->Step()) {
    if (!row) return tl::make_unexpected(row.error());
    const auto map = [&select](int column) {
      return MapId{select->Word(column), static_cast<std::uint32_t>(select->Word(column + 1))};
    };
    separations.emplace_back(map(0), map(2));
  }
  return separations;
}

Status Store::ForEachEditsAfter(std::uint64_t position, const std::function<Status(const JournalEntry&)>& visit) {
  auto select = Statement::Prepare(*database_, R"(
    SELECT position, session, sequence, base_correction_version, wire_version, checksum, edits
    FROM envelopes WHERE position > ?1
    UNION ALL SELECT position, 0, 0, 0, wire_version, 0, edits
    FROM server_edits WHERE position > ?1 ORDER BY position)");
  if (!select) return tl::make_unexpected(select.error());
  select->Bind(position);
  for (auto row = select->Step(); !row || *row; row = select->Step()) {
    if (!row) return tl::make_unexpected(row.error());
    const auto edits = select->Blob(6);
    const JournalEntry entry{
        select->Word(0),
        {select->Word(1), select->Word(2), select->Word(3), static_cast<std::uint32_t>(select->Word(4)),
         select->Word(5), std::vector<std::byte>(edits.begin(), edits.end())}};
    if (auto status = visit(entry); !status) return status;
  }
  return {};
}

StoreSize Store::Size() {
  StoreSize size;
  size.bytes = FileBytes(path()) + FileBytes(path().string() + "-wal");
  size.journaled_envelopes =
      static_cast<std::uint64_t>(database_->Number("SELECT count(*) FROM envelopes").value_or(0));
  return size;
}

Status Store::SetMaxBytes(std::uint64_t max_bytes) { return ConfigureForWriting(*database_, max_bytes); }

}  // namespace pangaea
