// SPDX-License-Identifier: Apache-2.0
#include "bench/data_sets/labels.h"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/errors/bench_error.h"
#include "daq/record.h"
#include "daq/record_error.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kFileColumn = "file";
constexpr std::string_view kUnitColumn = "unit";
constexpr std::string_view kExpectedHeader = "a header such as file,unit,class";

std::string Place(const fs::path& path, int line, int column) {
  return fmt::format("{}:{}:{}", path.string(), line, column);
}

std::string TextOf(const fs::path& path) {
  try {
    return daq::ReadWholeFile(path);
  } catch (const daq::RecordError& error) {
    throw BenchError(ExitCode::kWrongInput, error.what());
  }
}

std::vector<std::string> HeaderOf(const fs::path& path, std::string_view line, int number) {
  std::vector<std::string> names;
  for (const daq::Cell& cell : daq::SplitCells(line, ',')) {
    const std::string place = Place(path, number, cell.column);
    if (cell.text.empty()) Refuse(place, "a column has no name", std::string(kExpectedHeader));
    if (std::ranges::find(names, cell.text) != names.end())
      Refuse(place, fmt::format("column '{}' is there twice", cell.text), "each column once");
    names.push_back(cell.text);
  }
  for (const std::string_view needed : {kFileColumn, kUnitColumn}) {
    if (std::ranges::find(names, needed) == names.end())
      Refuse(Place(path, number, 1), fmt::format("column '{}' is missing", needed),
             std::string(kExpectedHeader));
  }
  return names;
}

bool LeavesFolder(const fs::path& name) {
  const fs::path plain = name.lexically_normal();
  return plain.is_absolute() || (!plain.empty() && *plain.begin() == "..");
}

}  // namespace

Labels::Labels(fs::path path, std::vector<std::string> columns, std::vector<Row> rows)
    : path_(std::move(path)), columns_(std::move(columns)), rows_(std::move(rows)) {}

std::vector<std::string> Labels::columns() const {
  std::vector<std::string> names = columns_;
  std::erase_if(names, [](const std::string& name) { return name == kFileColumn || name == kUnitColumn; });
  return names;
}

bool Labels::Has(std::string_view column) const {
  return std::ranges::find(columns_, column) != columns_.end();
}

std::vector<std::string> Labels::WithPrefix(std::string_view prefix) const {
  std::vector<std::string> names;
  for (const std::string& column : columns_) {
    if (column.size() > prefix.size() && column.starts_with(prefix))
      names.push_back(column.substr(prefix.size()));
  }
  return names;
}

std::size_t Labels::ColumnOf(std::string_view name) const {
  const auto found = std::ranges::find(columns_, name);
  if (found == columns_.end())
    Refuse(Place(path_, 1, 1), fmt::format("column '{}' is missing", name),
           fmt::format("it beside {}", fmt::join(columns_, ", ")));
  return static_cast<std::size_t>(found - columns_.begin());
}

std::vector<std::string> Labels::Texts(std::string_view column) const {
  const std::size_t c = ColumnOf(column);
  std::vector<std::string> texts;
  for (const Row& row : rows_) texts.push_back(row.cells[c].text);
  return texts;
}

std::vector<double> Labels::Numbers(std::string_view column, double low, double high) const {
  const std::size_t c = ColumnOf(column);
  std::vector<double> numbers;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const std::string& text = rows_[r].cells[c].text;
    const std::optional<double> number = daq::NumberFromText(text);
    // NaN lies in no range.
    if (!number || !(*number >= low && *number <= high))
      RefuseCell(r, column, fmt::format("{} is {}", column, daq::Quoted(text)),
                 fmt::format("a number from {:g} to {:g}", low, high));
    numbers.push_back(*number);
  }
  return numbers;
}

std::vector<std::string> Labels::Units() const {
  std::vector<std::string> units;
  for (const Row& row : rows_) units.push_back(row.unit);
  return units;
}

void Labels::RefuseCell(std::size_t row, std::string_view column, const std::string& what,
                        const std::string& expected) const {
  const Row& at = rows_.at(row);
  const auto found = std::ranges::find(columns_, column);
  const int place =
      found == columns_.end() ? 1 : at.cells[static_cast<std::size_t>(found - columns_.begin())].column;
  Refuse(Place(path_, at.line, place), what, expected);
}

Labels ReadLabels(const fs::path& folder) {
  if (!fs::is_directory(folder)) Refuse(folder, "is no folder", "a folder of records with labels.csv");
  const fs::path path = folder / "labels.csv";
  if (!fs::exists(path))
    Refuse(folder, "has no labels.csv", "a table with the columns file, unit and what is known of each file");
  const std::string text = TextOf(path);
  if (const auto bad = daq::FindNonTextByte(text)) {
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(*bad), '\n');
    Refuse(fmt::format("{}:{}", path.string(), line), "is no UTF-8 text", "a CSV file with commas");
  }
  std::string_view rest = text;
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (rest.starts_with(kByteOrderMark)) rest.remove_prefix(kByteOrderMark.size());

  std::vector<std::string> columns;
  std::vector<Labels::Row> rows;
  std::map<fs::path, int> lines;
  std::size_t file_column{};
  std::size_t unit_column{};
  for (int number = 1; !rest.empty(); ++number) {
    const std::string_view line = daq::TakeLine(rest).text;
    if (daq::Trim(line).empty() || daq::Trim(line).starts_with('#')) continue;
    if (columns.empty()) {
      columns = HeaderOf(path, line, number);
      file_column = static_cast<std::size_t>(std::ranges::find(columns, kFileColumn) - columns.begin());
      unit_column = static_cast<std::size_t>(std::ranges::find(columns, kUnitColumn) - columns.begin());
      continue;
    }
    Labels::Row row{.file = {}, .name = {}, .unit = {}, .line = number, .cells = daq::SplitCells(line, ',')};
    if (row.cells.size() != columns.size())
      Refuse(Place(path, number, 1), fmt::format("{} cells", row.cells.size()),
             fmt::format("{}: {}", columns.size(), fmt::join(columns, ", ")));
    row.name = row.cells[file_column].text;
    row.unit = row.cells[unit_column].text;
    const std::string place = Place(path, number, row.cells[file_column].column);
    if (row.name.empty() || LeavesFolder(row.name))
      Refuse(place, fmt::format("file is {}", daq::Quoted(row.name)), "a file below the folder");
    if (row.unit.empty())
      Refuse(Place(path, number, row.cells[unit_column].column), "unit is empty",
             "a name of the assembly or specimen");
    row.file = folder / row.name;
    if (!fs::is_regular_file(row.file))
      Refuse(place, fmt::format("{} names no file", daq::Quoted(row.name)), "a record below the folder");
    const auto [before, is_new] = lines.emplace(fs::path(row.name).lexically_normal(), number);
    if (!is_new)
      Refuse(place, fmt::format("{} is there twice, in line {} too", daq::Quoted(row.name), before->second),
             "each file once");
    rows.push_back(std::move(row));
  }
  if (columns.empty()) Refuse(Place(path, 1, 1), "has no header", std::string(kExpectedHeader));
  if (rows.empty()) Refuse(Place(path, 1, 1), "has no rows", "a row for each record");
  return {path, std::move(columns), std::move(rows)};
}

std::vector<int> NumbersOfGroups(const std::vector<std::string>& groups) {
  std::map<std::string, int> numbers;
  std::vector<int> result;
  for (const std::string& group : groups)
    result.push_back(numbers.emplace(group, static_cast<int>(numbers.size())).first->second);
  return result;
}

}  // namespace strainwave::bench
