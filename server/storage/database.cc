#include "server/storage/database.h"

#include <sqlite3.h>

#include <utility>

namespace pangaea {
namespace {

// How long one connection waits for another's transaction. Transactions are kept short (see SnapshotStore), so this
// is only reached when the disk itself hangs.
constexpr int kBusyTimeoutMilliseconds = 10'000;

ErrorCode CodeOf(int sqlite_code) {
  switch (sqlite_code & 0xff) {
    case SQLITE_FULL:
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
    case SQLITE_IOERR:
    case SQLITE_NOMEM:
    case SQLITE_CANTOPEN:
      return ErrorCode::kUnavailable;
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return ErrorCode::kCorrupt;
    default:
      return ErrorCode::kRefused;
  }
}

Error ErrorOf(sqlite3* connection, const std::string& path) {
  return {CodeOf(sqlite3_extended_errcode(connection)), path + ": " + sqlite3_errmsg(connection)};
}

}  // namespace

void Database::Closer::operator()(sqlite3* connection) const { sqlite3_close_v2(connection); }

Result<Database> Database::Open(const std::filesystem::path& path, Access access) {
  const int flags = access == Access::kReadOnly ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  sqlite3* raw = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &raw, flags | SQLITE_OPEN_NOMUTEX, nullptr);
  Connection connection(raw);
  if (code != SQLITE_OK) {
    return Fail(CodeOf(code), path.string() + ": " + (raw == nullptr ? "out of memory" : sqlite3_errmsg(raw)));
  }
  sqlite3_busy_timeout(raw, kBusyTimeoutMilliseconds);
  return Database(path, std::move(connection));
}

Status Database::Execute(const char* sql) {
  if (sqlite3_exec(handle(), sql, nullptr, nullptr, nullptr) != SQLITE_OK) return LastError();
  return {};
}

Result<std::int64_t> Database::Number(const char* sql) {
  auto statement = Statement::Prepare(*this, sql);
  if (!statement) return tl::make_unexpected(statement.error());
  const auto row = statement->Step();
  if (!row) return tl::make_unexpected(row.error());
  return *row ? statement->Number(0) : 0;
}

int Database::ChangedRows() const { return sqlite3_changes(handle()); }

tl::unexpected<Error> Database::LastError() const { return tl::make_unexpected(ErrorOf(handle(), path_.string())); }

void Statement::Finalizer::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

Statement::Statement(const Database& database, sqlite3_stmt* statement)
    : path_(database.path().string()), statement_(statement) {}

Result<Statement> Statement::Prepare(const Database& database, const char* sql) {
  sqlite3_stmt* raw = nullptr;
  if (sqlite3_prepare_v2(database.handle(), sql, -1, &raw, nullptr) != SQLITE_OK) return database.LastError();
  return Statement(database, raw);
}

Statement& Statement::Bind(std::int64_t value) {
  bound_ = sqlite3_bind_int64(statement_.get(), next_parameter_++, value) == SQLITE_OK && bound_;
  return *this;
}

Statement& Statement::Bind(std::string_view text) {
  bound_ = sqlite3_bind_text64(statement_.get(), next_parameter_++, text.data(), text.size(), SQLITE_STATIC,
                               SQLITE_UTF8) == SQLITE_OK &&
           bound_;
  return *this;
}

Statement& Statement::Bind(std::span<const std::byte> blob) {
  // A null pointer would bind NULL instead of an empty blob.
  const void* data = blob.empty() ? static_cast<const void*>("") : blob.data();
  bound_ =
      sqlite3_bind_blob64(statement_.get(), next_parameter_++, data, blob.size(), SQLITE_STATIC) == SQLITE_OK && bound_;
  return *this;
}

Result<bool> Statement::Step() {
  if (!bound_) return tl::make_unexpected(LastError());
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  return tl::make_unexpected(LastError());
}

Status Statement::Run() {
  const auto row = Step();
  Status status;
  if (!row) status = tl::make_unexpected(row.error());
  Reset();
  return status;
}

void Statement::Reset() {
  sqlite3_reset(statement_.get());
  sqlite3_clear_bindings(statement_.get());
  next_parameter_ = 1;
  bound_ = true;
}

std::int64_t Statement::Number(int column) const { return sqlite3_column_int64(statement_.get(), column); }

std::string Statement::Text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
  return text == nullptr ? std::string()
                         : std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column)));
}

std::span<const std::byte> Statement::Blob(int column) const {
  const auto* data = static_cast<const std::byte*>(sqlite3_column_blob(statement_.get(), column));
  return {data, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

Error Statement::LastError() const { return ErrorOf(sqlite3_db_handle(statement_.get()), path_); }

Result<Transaction> Transaction::Begin(Database& database) {
  if (auto status = database.Execute("BEGIN IMMEDIATE"); !status) return tl::make_unexpected(status.error());
  return Transaction(&database);
}

Transaction::Transaction(Transaction&& other) noexcept : database_(std::exchange(other.database_, nullptr)) {}

Transaction::~Transaction() {
  // SQLite may have rolled back by itself (disk full); then this fails, harmlessly.
  if (database_ != nullptr) (void)database_->Execute("ROLLBACK");
}

Status Transaction::Commit() {
  if (auto status = database_->Execute("COMMIT"); !status) return status;
  database_ = nullptr;
  return {};
}

}  // namespace pangaea
