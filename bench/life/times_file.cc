// SPDX-License-Identifier: Apache-2.0
#include "bench/life/times_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/errors/bench_error.h"
#include "daq/csv_text.h"
#include "daq/record.h"
#include "daq/record_error.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;
using analysis::reliability::kNever, analysis::reliability::Lifetime;

constexpr std::string_view kHeader = "a header such as unit,time_h,status";
constexpr std::string_view kStatuses = "failed, suspended, before, between or ran";
constexpr std::string_view kKnown[] = {"unit", "status", "count", "mode", "torque_Nm", "speed_rpm"};

struct Reader {
  const fs::path& path;
  std::vector<std::string> columns;
  std::vector<std::string> wrong;

  void Wrong(int line, int column, const std::string& what, std::string_view expected) {
    wrong.push_back(
        fmt::format("{}:{}:{}: error: {} (expected {})", path.string(), line, column, what, expected));
  }

  std::optional<std::size_t> Column(std::string_view name) const {
    const auto found = std::ranges::find(columns, name);
    if (found == columns.end()) return std::nullopt;
    return static_cast<std::size_t>(found - columns.begin());
  }

  // Nothing where the column is not there or its cell is empty.
  const daq::Cell* Cell(const std::vector<daq::Cell>& row, std::string_view name) const {
    const auto c = Column(name);
    return c && !row[*c].text.empty() ? &row[*c] : nullptr;
  }

  std::optional<double> Positive(const std::vector<daq::Cell>& row, int line, const std::string& name) {
    const auto c = Column(name);
    if (!c) return std::nullopt;
    const daq::Cell& cell = row[*c];
    const std::optional<double> number = daq::NumberFromText(cell.text);
    if (number && std::isfinite(*number) && *number > 0.0) return number;
    Wrong(line, cell.column, fmt::format("{} is {}", name, daq::Quoted(cell.text)), "a number above zero");
    return std::nullopt;
  }
};

std::string ReadAll(const fs::path& path) {
  try {
    return daq::ReadWholeFile(path);
  } catch (const daq::RecordError& error) {
    throw BenchError(ExitCode::kWrongInput, error.what());
  }
}

// What is read of one row.
struct Parsed {
  std::optional<Lifetime> life;
  bool ran_on{};  // a step that the unit passed
};

Parsed ParseLife(Reader& reader, const std::vector<daq::Cell>& row, int line, const std::string& unit) {
  const std::optional<double> time = reader.Positive(row, line, "time_" + unit);
  const daq::Cell* const cell = reader.Cell(row, "status");
  const std::string status =
      cell == nullptr && !reader.Column("status") ? "failed" : (cell ? cell->text : "");
  if (status != "failed" && status != "suspended" && status != "before" && status != "between" &&
      status != "ran") {
    const auto c = reader.Column("status");
    reader.Wrong(line, row[*c].column, fmt::format("status is {}", daq::Quoted(status)), kStatuses);
    return {};
  }
  if (!time) return {};
  if (status == "failed") return {Lifetime::Failed(*time)};
  if (status == "suspended") return {Lifetime::Suspended(*time)};
  if (status == "before") return {Lifetime::FailedBefore(*time)};
  if (status == "ran") return {Lifetime::Suspended(*time), true};
  const std::string since_name = "since_" + unit;
  if (!reader.Column(since_name)) {
    reader.Wrong(line, cell->column,
                 fmt::format("status is 'between', and there is no column {}", since_name),
                 "the time at which the unit was last seen to run");
    return {};
  }
  const std::optional<double> since = reader.Positive(row, line, since_name);
  if (!since) return {};
  if (*since >= *time) {
    reader.Wrong(line, row[*reader.Column(since_name)].column,
                 fmt::format("{} = {:g} is not before time_{} = {:g}", since_name, *since, unit, *time),
                 "the interval that the failure lies in");
    return {};
  }
  return {Lifetime::FailedBetween(*since, *time)};
}

std::string UnitOfTime(const Reader& reader) {
  std::vector<std::string> units;
  for (const std::string& column : reader.columns) {
    if (column.starts_with("time_") && column.size() > 5) units.push_back(column.substr(5));
  }
  if (units.size() == 1) return units.front();
  Refuse(fmt::format("{}:1:1", reader.path.string()),
         units.empty() ? "no column says the times" : fmt::format("{} columns say times", units.size()),
         "one whose name ends in their unit, such as time_h or time_cycles");
}

void ReadHeader(Reader& reader, std::string_view line) {
  for (const daq::Cell& cell : daq::SplitCells(line, ',')) {
    if (cell.text.empty()) reader.Wrong(1, cell.column, "a column has no name", kHeader);
    if (reader.Column(cell.text))
      reader.Wrong(1, cell.column, fmt::format("column '{}' is there twice", cell.text), "each column once");
    reader.columns.push_back(cell.text);
  }
}

// Rows of one unit that follow each other are its steps: all but the last are passed.
void AddRow(Reader& reader, TimesTable& table, const std::vector<daq::Cell>& cells, int line,
            std::map<std::string, std::size_t>& ended, std::optional<TimesRow>& running) {
  const Parsed parsed = ParseLife(reader, cells, line, table.unit);
  TimesRow row;
  row.line = line;
  if (const daq::Cell* const name = reader.Cell(cells, "unit")) row.name = name->text;
  LoadStep step;
  bool sound = parsed.life.has_value();
  const auto load = [&](const char* name, double& value) {
    if (!reader.Column(name)) return;
    const std::optional<double> number = reader.Positive(cells, line, name);
    sound = sound && number;
    value = number.value_or(0.0);
  };
  load("torque_Nm", step.torque_Nm);
  load("speed_rpm", step.speed_rpm);
  double count = 1.0;
  if (reader.Column("count")) {
    const std::optional<double> number = reader.Positive(cells, line, "count");
    sound = sound && number;
    count = number.value_or(1.0);
  }
  if (!sound) return;
  row.life = *parsed.life;
  row.life.count = count;
  step.end = row.life.is_failure() ? row.life.upper : row.life.lower;
  const bool goes_on = running && !row.name.empty() && running->name == row.name;
  if (running && !goes_on) {
    reader.Wrong(running->line, 1,
                 fmt::format("unit '{}' ran on, and no row says how it ended", running->name),
                 "a row with a later time and another status");
    running.reset();
  }
  if (goes_on) {
    if (step.end <= running->steps.back().end) {
      reader.Wrong(line, cells[*reader.Column("time_" + table.unit)].column,
                   fmt::format("time_{} = {:g} is not after that of the step before, {:g}", table.unit,
                               step.end, running->steps.back().end),
                   "times of a unit that grow");
      return;
    }
    row.steps = running->steps;
    running.reset();
  }
  row.steps.push_back(step);
  if (parsed.ran_on) {
    if (row.name.empty()) {
      reader.Wrong(line, 1, "status is 'ran', and the row names no unit",
                   "a column unit, the same in all of its steps");
      return;
    }
    running = row;
    return;
  }
  if (!row.name.empty() && !ended.emplace(row.name, table.rows.size()).second) {
    reader.Wrong(line, 1, fmt::format("unit '{}' ends twice", row.name),
                 "each unit once, but for steps that it ran on from");
    return;
  }
  if (const daq::Cell* const mode = reader.Cell(cells, "mode")) {
    if (!row.life.is_failure()) {
      reader.Wrong(line, mode->column, fmt::format("a suspended unit has mode {}", daq::Quoted(mode->text)),
                   "a mode of failures alone");
      return;
    }
    const auto found = std::ranges::find(table.modes, mode->text);
    row.mode = static_cast<int>(found - table.modes.begin());
    if (found == table.modes.end()) table.modes.push_back(mode->text);
  } else if (const auto c = reader.Column("mode"); c && row.life.is_failure()) {
    reader.Wrong(line, cells[*c].column, "a failure has no mode", "what failed, in a word, of each failure");
    return;
  }
  table.rows.push_back(row);
}

}  // namespace

std::vector<Lifetime> TimesTable::lifetimes() const {
  std::vector<Lifetime> lives;
  for (const TimesRow& row : rows) lives.push_back(row.life);
  return lives;
}

TimesTable ReadTimes(const fs::path& path) {
  const std::string text = ReadAll(path);
  if (const auto bad = daq::FindNonTextByte(text)) {
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(*bad), '\n');
    Refuse(fmt::format("{}:{}", path.string(), line), "is no UTF-8 text", "a CSV file with commas");
  }
  std::string_view rest = text;
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (rest.starts_with(kByteOrderMark)) rest.remove_prefix(kByteOrderMark.size());
  Reader reader{path, {}, {}};
  TimesTable table;
  table.path = path;
  std::map<std::string, std::size_t> ended;
  std::optional<TimesRow> running;
  for (int number = 1; !rest.empty(); ++number) {
    const std::string_view line = daq::TakeLine(rest).text;
    if (number == 1) {
      ReadHeader(reader, line);
      if (!reader.wrong.empty()) break;
      table.unit = UnitOfTime(reader);
      continue;
    }
    if (daq::Trim(line).empty()) continue;
    const std::vector<daq::Cell> cells = daq::SplitCells(line, ',');
    if (cells.size() != reader.columns.size()) {
      reader.Wrong(number, 1, fmt::format("{} cells", cells.size()),
                   fmt::format("{}, one a column", reader.columns.size()));
      continue;
    }
    AddRow(reader, table, cells, number, ended, running);
  }
  if (running)
    reader.Wrong(running->line, 1,
                 fmt::format("unit '{}' ran on, and no row says how it ended", running->name),
                 "a row with a later time and another status");
  if (!reader.wrong.empty())
    throw BenchError(ExitCode::kWrongInput, fmt::format("{}", fmt::join(reader.wrong, "\n")));
  if (table.rows.empty()) Refuse(path, "has no unit", std::string(kHeader) + " and a row for each");
  table.has_torque = reader.Column("torque_Nm").has_value();
  table.has_speed = reader.Column("speed_rpm").has_value();
  if (!reader.Column("status"))
    table.warnings.push_back(
        fmt::format("{}: there is no column status: every unit counts as failed", path.string()));
  for (const std::string& column : reader.columns) {
    const bool known = std::ranges::find(kKnown, column) != std::end(kKnown) ||
                       column == "time_" + table.unit || column == "since_" + table.unit;
    if (!known) table.warnings.push_back(fmt::format("{}: column '{}' is not used", path.string(), column));
  }
  return table;
}

}  // namespace strainwave::bench
