#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

struct sqlite3;
struct sqlite3_stmt;

namespace pangaea {

// One connection to an SQLite file. A connection and its statements belong to one thread at a time.
// Errors: kUnavailable where trying later may help (disk full, busy, input/output), kCorrupt where the file is not
// what it claims to be, kRefused otherwise; the message is SQLite's own with the path.
class Database {
 public:
  enum class Access { kReadOnly, kReadWrite };
  static Result<Database> Open(const std::filesystem::path& path, Access access);

  Database(Database&&) noexcept = default;
  Database& operator=(Database&&) noexcept = default;

  // One or several statements without parameters or results.
  Status Execute(const char* sql);
  // The number in the first column of the first row.
  Result<std::int64_t> Number(const char* sql);

  // How many rows the last INSERT, UPDATE or DELETE changed.
  int ChangedRows() const;

  sqlite3* handle() const { return connection_.get(); }
  const std::filesystem::path& path() const { return path_; }
  tl::unexpected<Error> LastError() const;

 private:
  struct Closer {
    void operator()(sqlite3* connection) const;
  };
  using Connection = std::unique_ptr<sqlite3, Closer>;
  Database(std::filesystem::path path, Connection connection)
      : path_(std::move(path)), connection_(std::move(connection)) {}

  std::filesystem::path path_;
  Connection connection_;
};

// A prepared statement: bind the parameters in order, step through the rows, reset to use it again.
// Failures are kept and reported by the next Step, so that binding needs no checks.
class Statement {
 public:
  static Result<Statement> Prepare(const Database& database, const char* sql);

  Statement& Bind(std::int64_t value);
  // Words of 64 bits without sign are stored bit by bit as SQLite's signed ones.
  Statement& Bind(std::uint64_t value) { return Bind(static_cast<std::int64_t>(value)); }
  Statement& Bind(std::uint32_t value) { return Bind(static_cast<std::int64_t>(value)); }
  // Not copied: the text or the bytes must live until the statement was reset.
  Statement& Bind(std::string_view text);
  Statement& Bind(std::span<const std::byte> blob);

  // True: a row can be read. False: done.
  Result<bool> Step();
  // For statements without rows: steps once and resets.
  Status Run();
  void Reset();

  std::int64_t Number(int column) const;
  std::uint64_t Word(int column) const { return static_cast<std::uint64_t>(Number(column)); }
  std::string Text(int column) const;
  // Valid until the next Step or Reset.
  std::span<const std::byte> Blob(int column) const;

 private:
  struct Finalizer {
    void operator()(sqlite3_stmt* statement) const;
  };
  explicit Statement(const Database& database, sqlite3_stmt* statement);
  Error LastError() const;

  std::string path_;
  std::unique_ptr<sqlite3_stmt, Finalizer> statement_;
  int next_parameter_ = 1;
  bool bound_ = true;
};

// All reads within its life see one state of the file, whatever others write meanwhile.
class ReadTransaction {
 public:
  explicit ReadTransaction(Database& database) : database_(database) { (void)database_.Execute("BEGIN"); }
  ~ReadTransaction() { (void)database_.Execute("COMMIT"); }
  ReadTransaction(const ReadTransaction&) = delete;
  ReadTransaction& operator=(const ReadTransaction&) = delete;

 private:
  Database& database_;
};

// Takes the right to write at Begin; rolled back at destruction unless committed.
class Transaction {
 public:
  static Result<Transaction> Begin(Database& database);
  Transaction(Transaction&& other) noexcept;
  Transaction& operator=(Transaction&&) = delete;
  ~Transaction();

  Status Commit();

 private:
  explicit Transaction(Database* database) : database_(database) {}
  Database* database_;  // null once committed or moved from
};

}  // namespace pangaea
