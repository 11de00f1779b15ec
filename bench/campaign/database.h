// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "bench/campaign/checked_pages.h"

struct sqlite3;
struct sqlite3_stmt;

namespace strainwave::bench {

/// What SQLite said, with the file.
class DatabaseError : public std::runtime_error {
 public:
  DatabaseError(const std::filesystem::path& file, int code, const std::string& message);
  int code() const { return code_; }

 private:
  int code_;
};

/// One prepared statement. Parameters are bound in order, columns read by index.
class Statement {
 public:
  Statement(sqlite3* database, const std::filesystem::path& file, std::string_view sql);

  Statement& Bind(std::int64_t value);
  Statement& Bind(int value) { return Bind(static_cast<std::int64_t>(value)); }
  Statement& Bind(double value);
  Statement& Bind(std::string_view value);
  Statement& BindBlob(std::string_view bytes);
  Statement& BindNull();

  /// True while there is a row to read.
  bool Step();
  /// Runs a statement that gives no rows, and makes it ready to be bound again.
  void Run();

  /// Makes it ready to be bound again, wherever it stands.
  void Reset();

  enum class Type { kNull, kInteger, kReal, kText };  // no table has a blob
  int Columns() const;
  Type TypeOf(int column) const;
  std::int64_t Integer(int column) const;
  double Real(int column) const;
  std::string Text(int column) const;
  std::string Blob(int column) const;
  bool IsNull(int column) const;

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  void Check(int code) const;

  sqlite3* database_;
  std::filesystem::path file_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  int next_parameter_{1};
};

/// An open SQLite file in WAL mode; every commit is on the disk when it returns (synchronous=FULL).
///
/// kReadWrite leaves the write-ahead log, empty, and its index beside the file: where SQLite cannot make
/// them, as on a read-only medium, it opens no file in WAL mode (sqlite.org/wal.html, "Read-Only Databases").
class Database {
 public:
  /// kReadOnly also reads what cannot be written to: a read-only medium, the folder of another user, a
  /// write-ahead log that a killed program has left there. kCreateChecked: a new one, with a checksum in
  /// every page (`page_checksums.h`); it has them in every mode from then on.
  enum class Mode { kReadOnly, kReadWrite, kCreate, kCreateChecked };

  /// @throws DatabaseError when it cannot be opened or is not a database.
  Database(const std::filesystem::path& file, Mode mode);

  Statement Prepare(std::string_view sql) const;
  void Execute(const std::string& sql) const;
  std::int64_t LastInsertId() const;
  const std::filesystem::path& file() const { return file_; }

 private:
  struct Close {
    void operator()(sqlite3* database) const;
  };
  void Open(int flags, Sharing sharing);
  void OpenToRead();
  void KeepLog() const;

  std::filesystem::path file_;
  std::unique_ptr<sqlite3, Close> database_;
};

/// Rolled back unless committed.
class Transaction {
 public:
  explicit Transaction(const Database& database);
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  ~Transaction();
  void Commit();

 private:
  const Database& database_;
  bool open_{true};
};

/// The same within a transaction or without one: what it holds is rolled back unless released.
class Savepoint {
 public:
  explicit Savepoint(const Database& database);
  Savepoint(const Savepoint&) = delete;
  Savepoint& operator=(const Savepoint&) = delete;
  ~Savepoint();
  void Release();

 private:
  const Database& database_;
  bool open_{true};
};

}  // namespace strainwave::bench
