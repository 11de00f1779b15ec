// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/database.h"

#include <cerrno>
#include <system_error>

#include <fmt/core.h>
#include <sqlite3.h>

#include "bench/campaign/page_checksums.h"
#include "daq/synced_folder.h"

namespace strainwave::bench {
namespace {

// What SQLite says, and where it was the machine that refused, what that said: no quota, no descriptor ...
// @param refused  errno; sqlite3_system_errno() does not know that of a commit.
std::string WordsOf(sqlite3* database, int refused) {
  const std::string words = sqlite3_errmsg(database);
  const int code = sqlite3_errcode(database) & 0xff;
  const bool by_machine = code == SQLITE_IOERR || code == SQLITE_CANTOPEN;
  return !by_machine || refused == 0 ? words
                                     : fmt::format("{}: {}", words, std::generic_category().message(refused));
}

}  // namespace

DatabaseError::DatabaseError(const std::filesystem::path& file, int code, const std::string& message)
    : std::runtime_error(fmt::format("{}: error: {}", file.string(), message)), code_(code) {}

void Statement::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

Statement::Statement(sqlite3* database, const std::filesystem::path& file, std::string_view sql)
    : database_(database), file_(file) {
  sqlite3_stmt* prepared = nullptr;
  Check(sqlite3_prepare_v2(database_, sql.data(), static_cast<int>(sql.size()), &prepared, nullptr));
  statement_.reset(prepared);
}

void Statement::Check(int code) const {
  if (code == SQLITE_OK || code == SQLITE_DONE || code == SQLITE_ROW) return;
  if (sqlite3_extended_errcode(database_) == SQLITE_IOERR_DATA) {
    throw DatabaseError(file_, code,
                        "a page does not match its checksum (expected the file as it was written)");
  }
  throw DatabaseError(file_, code, WordsOf(database_, errno));
}

Statement& Statement::Bind(std::int64_t value) {
  Check(sqlite3_bind_int64(statement_.get(), next_parameter_++, value));
  return *this;
}

Statement& Statement::Bind(double value) {
  Check(sqlite3_bind_double(statement_.get(), next_parameter_++, value));
  return *this;
}

Statement& Statement::Bind(std::string_view value) {
  // A view of nothing has no address, which SQLite takes for NULL.
  const char* const text = value.data() == nullptr ? "" : value.data();
  Check(sqlite3_bind_text(statement_.get(), next_parameter_++, text, static_cast<int>(value.size()),
                          SQLITE_TRANSIENT));
  return *this;
}

Statement& Statement::BindBlob(std::string_view bytes) {
  Check(sqlite3_bind_blob(statement_.get(), next_parameter_++, bytes.data(), static_cast<int>(bytes.size()),
                          SQLITE_TRANSIENT));
  return *this;
}

Statement& Statement::BindNull() {
  Check(sqlite3_bind_null(statement_.get(), next_parameter_++));
  return *this;
}

bool Statement::Step() {
  errno = 0;
  const int code = sqlite3_step(statement_.get());
  Check(code);
  return code == SQLITE_ROW;
}

void Statement::Reset() {
  Check(sqlite3_reset(statement_.get()));
  next_parameter_ = 1;
}

void Statement::Run() {
  while (Step()) {
  }
  Reset();
}

int Statement::Columns() const { return sqlite3_column_count(statement_.get()); }

Statement::Type Statement::TypeOf(int column) const {
  switch (sqlite3_column_type(statement_.get(), column)) {
    case SQLITE_NULL:
      return Type::kNull;
    case SQLITE_INTEGER:
      return Type::kInteger;
    case SQLITE_FLOAT:
      return Type::kReal;
    default:
      return Type::kText;
  }
}

std::int64_t Statement::Integer(int column) const { return sqlite3_column_int64(statement_.get(), column); }

double Statement::Real(int column) const { return sqlite3_column_double(statement_.get(), column); }

std::string Statement::Text(int column) const {
  const unsigned char* text = sqlite3_column_text(statement_.get(), column);
  return text == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(text));
}

std::string Statement::Blob(int column) const {
  const void* bytes = sqlite3_column_blob(statement_.get(), column);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
  return bytes == nullptr ? std::string() : std::string(static_cast<const char*>(bytes), size);
}

bool Statement::IsNull(int column) const {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL;
}

void Database::Close::operator()(sqlite3* database) const {
  // A log that is kept is emptied by the last who closes it; while it is in use its room on the disk is kept.
  sqlite3_exec(database, "PRAGMA journal_size_limit=0", nullptr, nullptr, nullptr);
  sqlite3_close_v2(database);
}

void Database::Open(int flags, Sharing sharing) {
  sqlite3* opened = nullptr;
  errno = 0;
  const int code = sqlite3_open_v2(file_.c_str(), &opened, flags, CheckedPages(sharing));
  database_.reset(opened);
  if (code != SQLITE_OK) {
    throw DatabaseError(file_, code, opened == nullptr ? "out of memory" : WordsOf(opened, errno));
  }
  sqlite3_busy_timeout(database_.get(), 5000);
}

// As beside a running program; where the files that this takes cannot be made, nobody else can write either.
void Database::OpenToRead() {
  try {
    Open(SQLITE_OPEN_READONLY, Sharing::kShared);
    Execute("SELECT 1 FROM sqlite_schema");
  } catch (const DatabaseError& error) {
    const int code = error.code() & 0xff;  // without its extension
    if (code != SQLITE_CANTOPEN && code != SQLITE_READONLY) throw;
    Open(SQLITE_OPEN_READONLY, Sharing::kSettled);
    // The index of the log in this program's memory, and the log left as it is.
    Execute("PRAGMA locking_mode=EXCLUSIVE");
    sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  }
}

void Database::KeepLog() const {
  int keep = 1;
  sqlite3_file_control(database_.get(), "main", SQLITE_FCNTL_PERSIST_WAL, &keep);
}

Database::Database(const std::filesystem::path& file, Mode mode) : file_(file) {
  if (mode == Mode::kReadOnly) {
    OpenToRead();
    return;
  }
  const int create = mode == Mode::kReadWrite ? 0 : SQLITE_OPEN_CREATE;
  Open(SQLITE_OPEN_READWRITE | create, Sharing::kShared);
  if (mode == Mode::kCreateChecked) {
    Execute(fmt::format("PRAGMA page_size={}", kPage_bytes));
    int reserved = kPageChecksum_bytes;
    sqlite3_file_control(database_.get(), "main", SQLITE_FCNTL_RESERVE_BYTES, &reserved);
  }
  Execute("PRAGMA journal_mode=WAL");
  if (mode == Mode::kReadWrite) {
    KeepLog();
    // SQLite syncs the name of its log, too, but does not look whether that succeeded.
    daq::SyncFolderOf(file);
  }
  Execute("PRAGMA synchronous=FULL");
  Execute("PRAGMA foreign_keys=ON");
}

Statement Database::Prepare(std::string_view sql) const { return Statement(database_.get(), file_, sql); }

void Database::Execute(const std::string& sql) const {
  errno = 0;
  const int code = sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) throw DatabaseError(file_, code, WordsOf(database_.get(), errno));
}

std::int64_t Database::LastInsertId() const { return sqlite3_last_insert_rowid(database_.get()); }

Transaction::Transaction(const Database& database) : database_(database) {
  database_.Execute("BEGIN IMMEDIATE");
}

Transaction::~Transaction() {
  if (!open_) return;
  try {
    database_.Execute("ROLLBACK");
  } catch (const DatabaseError&) {
    // SQLite has rolled back by itself (disk full, I/O error); the first error is on its way.
  }
}

void Transaction::Commit() {
  database_.Execute("COMMIT");
  open_ = false;
}

Savepoint::Savepoint(const Database& database) : database_(database) { database_.Execute("SAVEPOINT rows"); }

Savepoint::~Savepoint() {
  if (!open_) return;
  try {
    database_.Execute("ROLLBACK TO rows");
    database_.Execute("RELEASE rows");
  } catch (const DatabaseError&) {
    // SQLite has rolled back all of it by itself; the first error is on its way.
  }
}

void Savepoint::Release() {
  database_.Execute("RELEASE rows");
  open_ = false;
}

}  // namespace strainwave::bench
