// SPDX-License-Identifier: Apache-2.0
#include "bench/central/journal_rows.h"

#include <array>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "bench/central/server_columns.h"

namespace strainwave::bench {
namespace {

using nlohmann::json;

constexpr std::array<std::string_view, 6> kGrowing{"events",        "holes", "operator_notes",
                                                   "alarm_actions", "files", "chain"};
constexpr std::array<std::string_view, 2> kNamed{"campaign", "calibrations"};
constexpr int kRowsPerCycle = 20;

// One moment, however many statements look at it.
class ReadMoment {
 public:
  explicit ReadMoment(const Database& database) : database_(database) { database_.Execute("BEGIN"); }
  ReadMoment(const ReadMoment&) = delete;
  ReadMoment& operator=(const ReadMoment&) = delete;
  ~ReadMoment() {
    try {
      database_.Execute("COMMIT");
    } catch (const DatabaseError&) {
      // Nothing was written; the journal is opened anew for the next look.
    }
  }

 private:
  const Database& database_;
};

json ValueAt(const Statement& row, int column) {
  switch (row.TypeOf(column)) {
    case Statement::Type::kNull:
      return nullptr;
    case Statement::Type::kInteger:
      return row.Integer(column);
    case Statement::Type::kReal:
      return row.Real(column);
    case Statement::Type::kText:
      return ServerText(row.Text(column));
  }
  return nullptr;
}

json RowAt(const Statement& row) {
  json columns = json::array();
  for (int column = 0; column < row.Columns(); ++column) columns.push_back(ValueAt(row, column));
  return columns;
}

std::optional<double> RealAt(const Statement& row, int column) {
  return row.IsNull(column) ? std::nullopt : std::optional(row.Real(column));
}

// A journal of an earlier version does not say what the records of a cycle were.
bool HasDigests(const Database& database) { return ColumnsOf(database, "cycles") > 4; }

std::string PhasesOf(const Database& database, int cycle) {
  Statement statement = database.Prepare("SELECT * FROM phases WHERE cycle = ? ORDER BY id");
  statement.Bind(cycle);
  json phases = json::array();
  while (statement.Step()) phases.push_back(RowAt(statement));
  return phases.dump();
}

void ReadCycles(const Database& database, int after, int most, JournalBatch& batch) {
  Statement statement = database.Prepare(fmt::format(
      "SELECT cycle, outcome, started_s, ended_s, {} FROM cycles WHERE cycle > ? ORDER BY cycle LIMIT ?",
      HasDigests(database) ? "records_sha256" : "''"));
  statement.Bind(after).Bind(most + 1);
  while (statement.Step()) {
    if (static_cast<int>(batch.cycles.size()) == most) {
      batch.is_last = false;
      return;
    }
    const int cycle = static_cast<int>(statement.Integer(0));
    batch.cycles.push_back({cycle, statement.Text(1), statement.Real(2), RealAt(statement, 3),
                            statement.Text(4), PhasesOf(database, cycle)});
  }
}

// Of complete cycles: those of one under way may still be taken back.
void ReadResults(const Database& database, JournalBatch& batch) {
  Statement statement = database.Prepare(
      "SELECT repeat, quantity, value, standard_error, flag FROM results WHERE cycle = ? ORDER BY repeat, "
      "quantity");
  for (const SentCycle& cycle : batch.cycles) {
    if (cycle.outcome != "complete") continue;
    statement.Reset();
    statement.Bind(cycle.cycle);
    std::optional<SentResults> one;
    while (statement.Step()) {
      const int repeat = static_cast<int>(statement.Integer(0));
      if (one && one->repeat != repeat) batch.results.push_back(std::move(*one));
      if (!one || one->repeat != repeat) one = SentResults{cycle.cycle, repeat, {}, {}, {}, {}};
      one->quantities.push_back(ServerText(statement.Text(1)));
      one->values.push_back(RealAt(statement, 2));
      one->standard_errors.push_back(RealAt(statement, 3));
      one->flags.push_back(statement.Text(4));
    }
    if (one) batch.results.push_back(std::move(*one));
  }
}

void ReadGrowing(const Database& database, std::string_view table, std::int64_t after, int most,
                 JournalBatch& batch) {
  if (ColumnsOf(database, table) == 0) return;
  // The first column of each is its number.
  Statement statement =
      database.Prepare(fmt::format("SELECT * FROM {0} WHERE rowid > ? ORDER BY rowid LIMIT ?", table));
  statement.Bind(after).Bind(most + 1);
  for (int count = 0; statement.Step(); ++count) {
    if (count == most) {
      batch.is_last = false;
      return;
    }
    batch.rows.push_back({std::string(table), statement.Integer(0), "", RowAt(statement).dump()});
  }
}

void ReadNamed(const Database& database, std::string_view table, JournalBatch& batch) {
  Statement statement = database.Prepare(fmt::format("SELECT * FROM {}", table));
  while (statement.Step()) {
    batch.rows.push_back({std::string(table), 0, ServerText(statement.Text(0)), RowAt(statement).dump()});
  }
}

void ReadAlarms(const Journal& journal, JournalBatch& batch) {
  const Database& database = journal.database();
  if (ColumnsOf(database, "alarms") == 0) return;
  std::map<std::int64_t, std::string> rows;
  Statement statement = database.Prepare("SELECT * FROM alarms ORDER BY number");
  while (statement.Step()) rows[statement.Integer(0)] = RowAt(statement).dump();
  // Since before the first moment of bench time: all of them.
  for (AlarmInstance& instance : journal.Alarms(-1.0)) {
    const std::int64_t number = instance.number;
    batch.alarms.push_back({std::move(instance), rows[number]});
  }
}

}  // namespace

std::span<const std::string_view> GrowingTables() { return kGrowing; }
std::span<const std::string_view> NamedTables() { return kNamed; }

int ColumnsOf(const Database& database, std::string_view table) {
  Statement statement = database.Prepare("SELECT count(*) FROM pragma_table_info(?)");
  statement.Bind(table);
  statement.Step();
  return static_cast<int>(statement.Integer(0));
}

JournalBatch ReadBatch(const Journal& journal, const JournalMarks& marks, int most_cycles) {
  const Database& database = journal.database();
  const ReadMoment moment(database);
  JournalBatch batch;
  batch.is_last = true;
  ReadCycles(database, marks.cycle, most_cycles, batch);
  ReadResults(database, batch);
  for (const std::string_view table : kGrowing) {
    const auto mark = marks.table.find(std::string(table));
    ReadGrowing(database, table, mark == marks.table.end() ? 0 : mark->second, most_cycles * kRowsPerCycle,
                batch);
  }
  for (const std::string_view table : kNamed) ReadNamed(database, table, batch);
  ReadAlarms(journal, batch);
  return batch;
}

std::vector<JournalFile> FilesAfter(const Database& database, JournalFileMarks& marks) {
  std::vector<JournalFile> files;
  if (HasDigests(database)) {
    Statement cycles = database.Prepare(
        "SELECT cycle, records_sha256 FROM cycles WHERE cycle > ? AND outcome = 'complete' ORDER BY cycle");
    cycles.Bind(marks.cycle);
    while (cycles.Step()) {
      marks.cycle = static_cast<int>(cycles.Integer(0));
      files.push_back({fmt::format("cycles/{:06d}.h5", marks.cycle), cycles.Text(1)});
    }
  }
  if (ColumnsOf(database, "files") > 0) {
    Statement others = database.Prepare("SELECT id, path, sha256 FROM files WHERE id > ? ORDER BY id");
    others.Bind(marks.file);
    std::map<std::string, std::string> last;
    while (others.Step()) {
      marks.file = others.Integer(0);
      last[others.Text(1)] = others.Text(2);
    }
    for (const auto& [path, sha256] : last) files.push_back({path, sha256});
  }
  std::erase_if(files, [](const JournalFile& file) { return file.sha256.empty(); });
  return files;
}

}  // namespace strainwave::bench
