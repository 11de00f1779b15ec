// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/journal.h"

#include <algorithm>
#include <limits>
#include <system_error>

#include <fmt/core.h>
#include <sqlite3.h>

#include "bench/campaign/journal_chain.h"
#include "bench/campaign/page_checksums.h"
#include "bench/sha256.h"

namespace strainwave::bench {
namespace {

// Before pages had checksums and cycles the digest of their file; such a campaign goes on as it was begun.
constexpr int kVersionWithoutChecksums = 1;

constexpr const char* kSchema = R"sql(
CREATE TABLE campaign(key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE cycles(cycle INTEGER PRIMARY KEY, outcome TEXT NOT NULL, started_s REAL NOT NULL, ended_s REAL,
  records_sha256 TEXT NOT NULL DEFAULT '');
CREATE TABLE phases(id INTEGER PRIMARY KEY, cycle INTEGER NOT NULL REFERENCES cycles(cycle), step INTEGER NOT NULL,
  repeat INTEGER NOT NULL, attempt INTEGER NOT NULL, name TEXT NOT NULL, kind TEXT NOT NULL, started_s REAL NOT NULL,
  ended_s REAL, outcome TEXT NOT NULL, credited_load_s REAL NOT NULL DEFAULT 0,
  UNIQUE(cycle, step, repeat, attempt));
CREATE TABLE results(cycle INTEGER NOT NULL, repeat INTEGER NOT NULL, quantity TEXT NOT NULL, value REAL,
  standard_error REAL, flag TEXT NOT NULL, PRIMARY KEY(cycle, repeat, quantity)) WITHOUT ROWID;
CREATE TABLE events(id INTEGER PRIMARY KEY, time_s REAL NOT NULL, utc TEXT NOT NULL, cycle INTEGER NOT NULL,
  phase TEXT NOT NULL, severity TEXT NOT NULL, code TEXT NOT NULL, text TEXT NOT NULL);
CREATE TABLE holes(id INTEGER PRIMARY KEY, cycle INTEGER NOT NULL, phase TEXT NOT NULL, time_s REAL NOT NULL,
  start_utc TEXT NOT NULL, end_utc TEXT NOT NULL, cause TEXT NOT NULL, clock TEXT NOT NULL);
CREATE TABLE calibrations(name TEXT PRIMARY KEY, value REAL NOT NULL, standard_error REAL NOT NULL,
  unit TEXT NOT NULL, source TEXT NOT NULL, utc TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE operator_notes(id INTEGER PRIMARY KEY, utc TEXT NOT NULL, author TEXT NOT NULL, text TEXT NOT NULL);
)sql";

constexpr const char* kPhaseColumns =
    "id, cycle, step, repeat, attempt, name, kind, started_s, ended_s, outcome, credited_load_s";

std::int64_t Pragma(const Database& database, const char* name) {
  Statement statement = database.Prepare(fmt::format("PRAGMA {}", name));
  statement.Step();
  return statement.Integer(0);
}

// A page that a cut write has left is whole in the write-ahead log: where there is one, SQLite looks, which
// takes longer.
void Demand(const PageReport& report, const std::filesystem::path& file, Database::Mode mode) {
  if (report.first_damaged == 0 && !report.cut) return;
  std::error_code none;
  const auto log_bytes = std::filesystem::file_size(file.string() + "-wal", none);
  if (!none && log_bytes > 0) {
    const Database database(file, mode);
    Statement check = database.Prepare("PRAGMA integrity_check(1)");
    if (check.Step() && check.Text(0) == "ok") return;
  }
  throw DatabaseError(file, SQLITE_CORRUPT,
                      fmt::format("{} (expected the journal as it was written; bring it back from a copy)",
                                  report.first_damaged > 0
                                      ? fmt::format("page {} of {} does not match its checksum: a bit has "
                                                    "changed, or another program has written to it",
                                                    report.first_damaged, report.pages)
                                      : fmt::format("it is cut, {} pages are left", report.pages)));
}

// SQLite keeps a not-a-number as NULL, and gives that back as zero.
double RealOrNaN(const Statement& statement, int column) {
  return statement.IsNull(column) ? std::numeric_limits<double>::quiet_NaN() : statement.Real(column);
}

// Quantity, value, standard error, flag: four columns from this one on.
Result ResultAt(const Statement& statement, int first) {
  return {statement.Text(first), RealOrNaN(statement, first + 1), RealOrNaN(statement, first + 2),
          statement.Text(first + 3)};
}

}  // namespace

Journal::Journal(Database database, int version, std::uint32_t unsealed_pages)
    : database_(std::move(database)), version_(version), unsealed_pages_(unsealed_pages) {
  const auto last = [&](const char* table) {
    Statement statement = database_.Prepare(fmt::format("SELECT IFNULL(MAX(id), 0) FROM {}", table));
    statement.Step();
    return statement.Integer(0);
  };
  end_ = {last("phases"), last("events")};
}

Journal Journal::Create(const std::filesystem::path& file) {
  Database database(file, Database::Mode::kCreateChecked);
  Transaction transaction(database);
  database.Execute(fmt::format("PRAGMA application_id={}", kApplicationId));
  database.Execute(fmt::format("PRAGMA user_version={}", kVersion));
  database.Execute(kSchema);
  transaction.Commit();
  Journal journal(std::move(database), kVersion, 0);
  journal.AddTables();
  return journal;
}

Journal Journal::Open(const std::filesystem::path& file, Database::Mode mode) {
  if (!std::filesystem::exists(file)) {
    throw DatabaseError(file, SQLITE_CANTOPEN, "no such file (expected the journal of a campaign)");
  }
  const auto report = CheckPages(file, kApplicationId, kVersion);
  if (report) Demand(*report, file, mode);
  return OfFile(file, mode, report ? report->unsealed : 0);
}

Journal Journal::OpenAsRead(const std::filesystem::path& file, Database::Mode mode) {
  return OfFile(file, mode, 0);
}

Journal Journal::OfFile(const std::filesystem::path& file, Database::Mode mode,
                        std::uint32_t unsealed_pages) {
  Database database(file, mode);
  if (Pragma(database, "application_id") != kApplicationId) {
    throw DatabaseError(file, SQLITE_MISMATCH,
                        "not a campaign journal (expected a database that strainwave run has made)");
  }
  const auto version = static_cast<int>(Pragma(database, "user_version"));
  if (version != kVersion && version != kVersionWithoutChecksums) {
    throw DatabaseError(
        file, SQLITE_MISMATCH,
        fmt::format("journal version {} (expected {} or {})", version, kVersionWithoutChecksums, kVersion));
  }
  Journal journal(std::move(database), version, unsealed_pages);
  if (mode != Database::Mode::kReadOnly) journal.AddTables();
  return journal;
}

void Journal::AddTables() {
  AddAlarmTables();
  if (!is_chained() || HasChain(database_)) return;
  Transaction transaction(database_);
  // Another program may have been quicker.
  if (!HasChain(database_)) BeginChain(database_);
  transaction.Commit();
}

bool Journal::is_chained() const { return version_ != kVersionWithoutChecksums; }

std::string Journal::Unchecked() const {
  if (version_ == kVersionWithoutChecksums) {
    return "of an earlier version, without checksums: a bit that changes in it is not noticed";
  }
  if (unsealed_pages_ == 0) return "";
  return fmt::format(
      "{} pages were written by another program, without checksums: a bit that changes in them is not "
      "noticed",
      unsealed_pages_);
}

double Journal::LatestTime_s() const {
  // Bench time does not go back from row to row, so that the newest rows have the latest.
  Statement statement = database_.Prepare(
      "SELECT IFNULL(MAX(latest_s), 0.0) FROM ("
      "SELECT * FROM (SELECT time_s AS latest_s FROM events ORDER BY id DESC LIMIT 100) UNION ALL "
      "SELECT * FROM (SELECT time_s FROM holes ORDER BY id DESC LIMIT 100) UNION ALL "
      "SELECT * FROM (SELECT MAX(started_s, IFNULL(ended_s, started_s)) FROM cycles ORDER BY cycle DESC "
      "LIMIT 100) "
      "UNION ALL "
      "SELECT * FROM (SELECT MAX(started_s, IFNULL(ended_s, started_s)) FROM phases ORDER BY id DESC LIMIT "
      "100))");
  statement.Step();
  return statement.Real(0);
}

std::uint64_t Journal::Identity() const {
  const std::string sha256 =
      Sha256(Property("started_utc").value_or("") + Property("schedule_sha256").value_or(""));
  return std::stoull(sha256.substr(0, 16), nullptr, 16);
}

void Journal::SetProperty(std::string_view key, std::string_view value) {
  database_.Prepare("INSERT OR REPLACE INTO campaign(key, value) VALUES(?, ?)").Bind(key).Bind(value).Run();
}

std::optional<std::string> Journal::Property(std::string_view key) const {
  Statement statement = database_.Prepare("SELECT value FROM campaign WHERE key = ?");
  statement.Bind(key);
  if (!statement.Step()) return std::nullopt;
  return statement.Text(0);
}

void Journal::BeginCycle(int cycle, double time_s) {
  database_.Prepare("INSERT OR IGNORE INTO cycles(cycle, outcome, started_s) VALUES(?, 'running', ?)")
      .Bind(cycle)
      .Bind(time_s)
      .Run();
}

void Journal::EndCycle(int cycle, double time_s, std::string_view outcome, std::string_view records_sha256) {
  Savepoint all(database_);
  database_.Prepare("UPDATE cycles SET outcome = ?, ended_s = ? WHERE cycle = ?")
      .Bind(outcome)
      .Bind(time_s)
      .Bind(cycle)
      .Run();
  if (version_ != kVersionWithoutChecksums) {
    database_.Prepare("UPDATE cycles SET records_sha256 = ? WHERE cycle = ?")
        .Bind(records_sha256)
        .Bind(cycle)
        .Run();
    if (outcome == "complete") AddLink(database_, ChainedRow::kCycle, std::to_string(cycle));
  }
  all.Release();
}

std::string Journal::RecordsSha256(int cycle) const {
  if (version_ == kVersionWithoutChecksums) return "";
  Statement statement = database_.Prepare("SELECT records_sha256 FROM cycles WHERE cycle = ?");
  statement.Bind(cycle);
  return statement.Step() ? statement.Text(0) : "";
}

std::vector<CycleRow> Journal::Cycles() const {
  Statement statement = database_.Prepare(
      "SELECT cycle, outcome, started_s, IFNULL(ended_s, started_s) FROM cycles ORDER BY cycle");
  std::vector<CycleRow> rows;
  while (statement.Step()) {
    rows.push_back(
        {static_cast<int>(statement.Integer(0)), statement.Text(1), statement.Real(2), statement.Real(3)});
  }
  return rows;
}

std::optional<double> Journal::MeanCycle_s(int newest, int fewest) const {
  Statement statement = database_.Prepare(
      "SELECT MAX(ended_s) - MIN(started_s), COUNT(*) FROM (SELECT started_s, ended_s FROM cycles WHERE "
      "outcome = "
      "'complete' AND cycle > 0 ORDER BY cycle DESC LIMIT ?)");
  statement.Bind(newest);
  statement.Step();
  const auto count = static_cast<int>(statement.Integer(1));
  if (count < std::max(1, fewest)) return std::nullopt;
  return statement.Real(0) / count;
}

int Journal::LastCompleteCycle() const {
  // From the end: most cycles of a long campaign are complete.
  Statement statement =
      database_.Prepare("SELECT cycle FROM cycles WHERE outcome = 'complete' ORDER BY cycle DESC LIMIT 1");
  return statement.Step() ? static_cast<int>(statement.Integer(0)) : -1;
}

std::int64_t Journal::BeginPhase(const PhaseRow& row) {
  database_
      .Prepare(
          "INSERT INTO phases(cycle, step, repeat, attempt, name, kind, started_s, outcome) "
          "VALUES(?, ?, ?, ?, ?, ?, ?, 'running')")
      .Bind(row.cycle)
      .Bind(row.step)
      .Bind(row.repeat)
      .Bind(row.attempt)
      .Bind(row.name)
      .Bind(row.kind)
      .Bind(row.started_s)
      .Run();
  end_.phase = database_.LastInsertId();
  return end_.phase;
}

void Journal::EndPhase(std::int64_t id, double time_s, std::string_view outcome, double credited_load_s) {
  database_.Prepare("UPDATE phases SET ended_s = ?, outcome = ?, credited_load_s = ? WHERE id = ?")
      .Bind(time_s)
      .Bind(outcome)
      .Bind(credited_load_s)
      .Bind(id)
      .Run();
}

std::vector<PhaseRow> Journal::Phases(int cycle) const {
  Statement statement =
      database_.Prepare(fmt::format("SELECT {} FROM phases WHERE cycle = ? ORDER BY id", kPhaseColumns));
  statement.Bind(cycle);
  std::vector<PhaseRow> rows;
  while (statement.Step()) {
    PhaseRow row;
    row.id = statement.Integer(0);
    row.cycle = static_cast<int>(statement.Integer(1));
    row.step = static_cast<int>(statement.Integer(2));
    row.repeat = static_cast<int>(statement.Integer(3));
    row.attempt = static_cast<int>(statement.Integer(4));
    row.name = statement.Text(5);
    row.kind = statement.Text(6);
    row.started_s = statement.Real(7);
    row.ended_s = statement.Real(8);
    row.outcome = statement.Text(9);
    row.credited_load_s = statement.Real(10);
    rows.push_back(std::move(row));
  }
  return rows;
}

double Journal::CreditedLoad_s(int first_cycle) const {
  Statement statement =
      database_.Prepare("SELECT IFNULL(SUM(credited_load_s), 0.0) FROM phases WHERE cycle >= ?");
  statement.Bind(first_cycle);
  statement.Step();
  return statement.Real(0);
}

void Journal::AddResults(int cycle, int repeat, const std::vector<Result>& results) {
  Statement statement = database_.Prepare(
      "INSERT OR REPLACE INTO results(cycle, repeat, quantity, value, standard_error, flag) VALUES(?, ?, ?, "
      "?, ?, ?)");
  for (const Result& result : results) {
    statement.Bind(cycle)
        .Bind(repeat)
        .Bind(result.quantity)
        .Bind(result.value)
        .Bind(result.standard_error)
        .Bind(result.flag)
        .Run();
  }
}

void Journal::ClearResults(int cycle) {
  database_.Prepare("DELETE FROM results WHERE cycle = ?").Bind(cycle).Run();
}

std::vector<Result> Journal::Results(int cycle, int repeat) const {
  Statement statement = database_.Prepare(
      "SELECT quantity, value, standard_error, flag FROM results WHERE cycle = ? AND repeat = ? ORDER BY "
      "quantity");
  statement.Bind(cycle).Bind(repeat);
  std::vector<Result> results;
  while (statement.Step()) {
    results.push_back(ResultAt(statement, 0));
  }
  return results;
}

// CROSS JOIN keeps the order of the loops: one place of the results' index a cycle, not all of its rows.
void Journal::ForEachResult(std::string_view prefix, const std::function<bool(const CycleResult&)>& take,
                            int first_cycle) const {
  Statement statement = database_.Prepare(
      "SELECT c.cycle, IFNULL(c.ended_s, c.started_s), r.quantity, r.value, r.standard_error, r.flag FROM "
      "cycles c "
      "CROSS JOIN results r ON r.cycle = c.cycle AND r.repeat = 0 AND r.quantity >= ? AND r.quantity < ? "
      "WHERE c.outcome = 'complete' AND c.cycle >= ? ORDER BY c.cycle");
  std::string past_all(prefix.empty() ? "\U0010FFFF" : prefix);
  if (!prefix.empty()) ++past_all.back();
  statement.Bind(prefix).Bind(std::string_view(past_all)).Bind(first_cycle);
  while (statement.Step()) {
    if (!take({static_cast<int>(statement.Integer(0)), statement.Real(1), ResultAt(statement, 2)})) return;
  }
}

// Cycle by cycle: what belongs to one lies together in the results, so that each page is read once.
void Journal::ForEachResultOf(std::span<const std::string> quantities, int first_cycle, int last_cycle,
                              const std::function<void(const CycleResult&)>& take) const {
  std::string places;
  for (std::size_t i = 0; i < quantities.size(); ++i) places += i == 0 ? "?" : ", ?";
  Statement statement = database_.Prepare(fmt::format(
      "SELECT c.cycle, IFNULL(c.ended_s, c.started_s), r.quantity, r.value, r.standard_error, r.flag FROM "
      "cycles c CROSS JOIN results r ON r.cycle = c.cycle AND r.repeat = 0 AND r.quantity IN ({}) "
      "WHERE c.cycle BETWEEN ? AND ? AND c.outcome = 'complete' AND r.value IS NOT NULL ORDER BY c.cycle",
      places));
  for (const std::string& quantity : quantities) statement.Bind(std::string_view(quantity));
  statement.Bind(first_cycle).Bind(last_cycle);
  while (statement.Step()) {
    take({static_cast<int>(statement.Integer(0)), statement.Real(1), ResultAt(statement, 2)});
  }
}

std::vector<Result> Journal::NewestResults(std::string_view quantity, std::size_t count) const {
  Statement statement = database_.Prepare(
      "SELECT r.quantity, r.value, r.standard_error, r.flag FROM cycles c CROSS JOIN results r ON r.cycle = "
      "c.cycle "
      "AND r.repeat = 0 AND r.quantity = ? WHERE c.outcome = 'complete' AND c.cycle > 0 ORDER BY c.cycle "
      "DESC LIMIT ?");
  statement.Bind(quantity).Bind(static_cast<std::int64_t>(count));
  std::vector<Result> results;
  while (statement.Step()) {
    results.push_back(ResultAt(statement, 0));
  }
  std::ranges::reverse(results);
  return results;
}

std::vector<int> Journal::RepeatsOf(int cycle) const {
  Statement statement =
      database_.Prepare("SELECT DISTINCT repeat FROM results WHERE cycle = ? ORDER BY repeat");
  statement.Bind(cycle);
  std::vector<int> repeats;
  while (statement.Step()) repeats.push_back(static_cast<int>(statement.Integer(0)));
  return repeats;
}

}  // namespace strainwave::bench
