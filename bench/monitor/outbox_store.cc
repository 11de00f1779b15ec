// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/outbox_store.h"

#include <utility>

#include <sqlite3.h>

#include "bench/errors/bench_error.h"
#include "daq/synced_folder.h"

namespace strainwave::bench {
namespace {

constexpr int kApplication = 0x53574f42;  // "SWOB", in the header of the file
constexpr int kVersion = 1;

std::int64_t Pragma(const Database& database, const std::string& name) {
  Statement statement = database.Prepare("PRAGMA " + name);
  statement.Step();
  return statement.Integer(0);
}

// Taken at the first change and held until the file is closed.
void Lock(const Database& database) {
  database.Execute("PRAGMA locking_mode=EXCLUSIVE");
  Transaction transaction(database);
  const bool is_new = Pragma(database, "application_id") == 0 && Pragma(database, "schema_version") == 0;
  if (is_new) {
    database.Execute(
        "CREATE TABLE entries(id INTEGER PRIMARY KEY AUTOINCREMENT, metrics BLOB NOT NULL);"
        "CREATE TABLE kept(name TEXT PRIMARY KEY, value INTEGER NOT NULL);"
        "PRAGMA application_id=" +
        std::to_string(kApplication) + ";PRAGMA user_version=" + std::to_string(kVersion));
  }
  transaction.Commit();
}

Database Opened(const std::filesystem::path& file) {
  try {
    Database database(file, Database::Mode::kCreate);
    // SQLite syncs the name of its log, and that there is no journal any more, but does not look whether that
    // succeeded: with the one the newest entries would go, with the other all of them.
    daq::SyncFolderOf(file);
    Lock(database);
    if (Pragma(database, "application_id") != kApplication || Pragma(database, "user_version") != kVersion) {
      Refuse(file, "this is a database of something else", "an outbox of this version, or no file");
    }
    return database;
  } catch (const DatabaseError& error) {
    if (error.code() == SQLITE_BUSY) Refuse(file, "another monitor has it open", "an outbox_file of its own");
    if (error.code() == SQLITE_NOTADB)
      Refuse(file, "this is no outbox", "a file that a monitor made, or none");
    throw;
  }
}

}  // namespace

OutboxStore::OutboxStore(const std::filesystem::path& file) : database_(Opened(file)) {}

std::vector<OutboxStore::Entry> OutboxStore::Entries() const {
  std::vector<Entry> entries;
  Statement statement = database_.Prepare("SELECT id, metrics FROM entries ORDER BY id");
  while (statement.Step()) {
    auto payload = protocols::ParseSparkplug(statement.Blob(1));
    if (!payload) {
      Refuse(file(), "entry " + std::to_string(statement.Integer(0)) + " cannot be read",
             "an outbox as a monitor left it; move the file away to begin a new one");
    }
    entries.push_back({statement.Integer(0), std::move(payload->metrics)});
  }
  return entries;
}

std::vector<std::int64_t> OutboxStore::Make(const Change& change) {
  Transaction transaction(database_);
  std::vector<std::int64_t> ids;
  Statement insert = database_.Prepare("INSERT INTO entries(metrics) VALUES(?)");
  for (const std::string& metrics : change.added) {
    insert.BindBlob(metrics).Run();
    ids.push_back(database_.LastInsertId());
  }
  if (!ids.empty()) Keep("last_window", change.last_window);
  Statement remove = database_.Prepare("DELETE FROM entries WHERE id = ?");
  for (const std::int64_t each : change.removed) remove.Bind(each).Run();
  Keep("dropped", static_cast<std::int64_t>(change.dropped));
  transaction.Commit();
  return ids;
}

void OutboxStore::KeepNextBirth(int number) { Keep("next_birth", number); }

std::int64_t OutboxStore::Kept(std::string_view name) const {
  Statement statement = database_.Prepare("SELECT value FROM kept WHERE name = ?");
  statement.Bind(name);
  return statement.Step() ? statement.Integer(0) : 0;
}

void OutboxStore::Keep(std::string_view name, std::int64_t value) {
  database_.Prepare("INSERT INTO kept VALUES(?, ?) ON CONFLICT(name) DO UPDATE SET value = excluded.value")
      .Bind(name)
      .Bind(value)
      .Run();
}

}  // namespace strainwave::bench
