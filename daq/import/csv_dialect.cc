// SPDX-License-Identifier: Apache-2.0
#include "daq/import/csv_dialect.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "daq/csv_text.h"
#include "daq/import/units.h"
#include "daq/record_error.h"
#include "daq/record_limits.h"

namespace strainwave::daq {
namespace {

constexpr std::string_view kSeparators = ";\t,| ";
// Lines that are looked at to tell the dialect; all of them are read by it afterwards.
constexpr std::size_t kLinesLookedAt = 300;

struct TextLine {
  std::string_view text;
  std::size_t begin{};
  int number{};
};

bool HoldsDigit(std::string_view text) {
  return std::ranges::any_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

std::optional<CellKind> KindOf(std::string_view cell, bool decimal_comma) {
  if (CsvNumber(cell, decimal_comma)) return CellKind::kNumber;
  if (ClockSeconds(cell)) return CellKind::kClock;
  if (!cell.empty() && !HoldsDigit(cell)) return CellKind::kWord;
  return std::nullopt;
}

std::string SeparatorName(char separator) {
  switch (separator) {
    case ';':
      return "semicolons";
    case '\t':
      return "tabs";
    case ',':
      return "commas";
    case '|':
      return "bars";
    default:
      return "blanks";
  }
}

std::vector<std::string> Texts(std::string_view line, char separator, bool ends_with_separator) {
  std::vector<std::string> texts;
  for (auto& [text, at] : CellsOf(line, separator, ends_with_separator)) texts.push_back(std::move(text));
  return texts;
}

// A reading, and how its header agrees with it.
struct Reading {
  CsvDialect dialect;
  bool header_fits{};
};

// "s;Nm;deg" or "[s];[Nm];[deg]"
bool IsUnitRow(const std::vector<std::string>& cells) {
  bool any = false;
  for (const std::string& cell : cells) {
    const bool bracketed = cell.size() > 1 && (cell.front() == '[' || cell.front() == '(');
    if (!cell.empty() && cell != "-" && !bracketed && !FindImportUnit(cell)) return false;
    any = any || !cell.empty();
  }
  return any;
}

// "key: value", "key = value", or two cells.
void AddPreamble(std::string_view line, char separator, CsvDialect& dialect) {
  std::string_view text = Trim(line);
  while (text.starts_with('#') || text.starts_with('%')) text = Trim(text.substr(1));
  if (text.empty()) return;
  for (const char sign : {':', '=', separator}) {
    const std::size_t at = text.find(sign);
    if (at == text.npos || at == 0) continue;
    std::string_view value = Trim(text.substr(at + 1));
    while (!value.empty() && value.back() == separator) value = Trim(value.substr(0, value.size() - 1));
    if (value.empty()) continue;
    dialect.preamble.emplace_back(Trim(text.substr(0, at)), value);
    return;
  }
}

// Loggers end each row with a separator; a last cell may also be empty in some rows.
bool EndWith(const std::vector<TextLine>& lines, char separator) {
  constexpr std::size_t kLast = 10;
  const std::size_t from = lines.size() - std::min(lines.size(), std::min(kLast, (lines.size() + 1) / 2));
  return std::all_of(lines.begin() + static_cast<std::ptrdiff_t>(from), lines.end(),
                     [separator](const TextLine& line) { return Trim(line.text).ends_with(separator); });
}

// Of the later half of the lines.
std::size_t UsualWidth(const std::vector<TextLine>& lines, char separator, bool ends) {
  std::map<std::size_t, std::size_t> counts;
  for (std::size_t l = lines.size() / 2; l < lines.size(); ++l)
    ++counts[Texts(lines[l].text, separator, ends).size()];
  std::size_t usual = 0;
  for (const auto& [width, count] : counts)
    if (usual == 0 || count >= counts[usual]) usual = width;
  return usual;
}

std::optional<Reading> Read(const std::vector<TextLine>& lines, char separator, bool decimal_comma) {
  // From the last line upwards: as many lines as have the same cells.
  std::vector<CellKind> kinds;
  std::size_t first = lines.size();
  const bool ends = separator != ' ' && EndWith(lines, separator);
  const std::size_t usual = UsualWidth(lines, separator, ends);
  for (std::size_t l = lines.size(); l-- > 0;) {
    const std::vector<std::string> cells = Texts(lines[l].text, separator, ends);
    if (kinds.empty() && cells.size() != usual) continue;  // a last row that is cut off is told later
    std::vector<CellKind> here;
    for (const std::string& cell : cells) {
      const std::optional<CellKind> kind = KindOf(cell, decimal_comma);
      if (!kind) break;
      here.push_back(*kind);
    }
    if (here.size() != cells.size() || (!kinds.empty() && here != kinds)) {
      // Cells that are empty or spoilt are told later, with their place, if the row is one of the table.
      const bool in_table = !kinds.empty() && cells.size() == kinds.size() && here.size() != cells.size();
      const auto good = std::ranges::count_if(
          cells, [&](const std::string& cell) { return CsvNumber(cell, decimal_comma).has_value(); });
      if (!(in_table && good > 0)) break;
    } else {
      kinds = here;
    }
    first = l;
  }
  if (first == lines.size()) return std::nullopt;
  const bool any_number = std::ranges::find(kinds, CellKind::kNumber) != kinds.end();
  if (!any_number || kinds.size() > kMostColumns) return std::nullopt;
  Reading reading;
  CsvDialect& dialect = reading.dialect;
  dialect.separator = separator;
  dialect.ends_with_separator = ends;
  dialect.decimal_comma = decimal_comma;
  dialect.first_row = lines[first].begin;
  dialect.first_line = lines[first].number;
  dialect.kinds = kinds;
  const std::size_t width = kinds.size();
  std::size_t above = first;
  const auto cells_above = [&](std::size_t l) {
    std::string_view text = Trim(lines[l].text);
    if (text.starts_with('#')) text = Trim(text.substr(1));
    std::vector<std::string> cells = Texts(text, separator, ends);
    // Above the labels of rows there may be no name, only the tab behind it.
    if (separator == '\t' && cells.size() + 1 == width && lines[l].text.starts_with('\t'))
      cells.insert(cells.begin(), "");
    return cells;
  };
  if (above > 0 && cells_above(above - 1).size() == width && IsUnitRow(cells_above(above - 1)) && above > 1 &&
      cells_above(above - 2).size() == width) {
    dialect.units = cells_above(--above);
  }
  if (above > 0 && cells_above(above - 1).size() == width) {
    dialect.names = cells_above(--above);
    dialect.has_header = true;
  }
  reading.header_fits = dialect.has_header || first == 0 || lines[first - 1].text.starts_with('#');
  dialect.units.resize(width);
  for (std::size_t c = 0; c < width; ++c) {
    if (!dialect.has_header) dialect.names.push_back(fmt::format("column {}", c + 1));
    if (dialect.names[c].empty()) dialect.names[c] = fmt::format("column {}", c + 1);
    const std::string_view own = SplitUnit(dialect.names[c]).unit;
    std::string& unit = dialect.units[c];
    if (const std::string bare = unit; bare.size() > 1 && (bare.front() == '[' || bare.front() == '('))
      unit = std::string(Trim(std::string_view(bare).substr(1, bare.size() - 2)));
    if (unit == "-") unit.clear();
    if (unit.empty()) unit = own;
  }
  for (std::size_t l = 0; l < above; ++l) AddPreamble(lines[l].text, separator, dialect);
  return reading;
}

std::vector<TextLine> FirstLines(std::string_view text, const std::string& file) {
  std::vector<TextLine> lines;
  std::string_view rest = text;
  for (int number = 1; !rest.empty() && lines.size() < kLinesLookedAt; ++number) {
    const auto begin = static_cast<std::size_t>(rest.data() - text.data());
    const std::string_view line = TakeLine(rest).text;
    DemandShort(line, file, static_cast<std::size_t>(number));
    if (!Trim(line).empty()) lines.push_back({line, begin, number});
  }
  return lines;
}

// "1.234,5" and "1,234.5"
bool HasThousands(std::string_view cell) {
  const std::size_t point = cell.find('.');
  const std::size_t comma = cell.find(',');
  return point != cell.npos && comma != cell.npos && HoldsDigit(cell) && !ClockSeconds(cell);
}

std::string Shown(const CsvDialect& dialect, std::string_view row) {
  std::vector<std::string> values;
  for (const auto& [cell, at] : CellsOf(row, dialect.separator, dialect.ends_with_separator)) {
    const std::optional<double> number = CsvNumber(cell, dialect.decimal_comma);
    values.push_back(number ? fmt::format("{}", *number) : cell);
  }
  return fmt::format("{} between the cells and decimal {}: {}", SeparatorName(dialect.separator),
                     dialect.decimal_comma ? "commas" : "points", fmt::join(values, " | "));
}

[[noreturn]] void RefuseNone(const std::vector<TextLine>& lines, const std::string& file) {
  for (const TextLine& line : lines) {
    for (const char separator : kSeparators) {
      if (separator == ',') continue;
      for (const auto& [cell, at] : CellsOf(line.text, separator, false)) {
        if (!HasThousands(cell) || std::ranges::count(cell, ',') > 1) continue;
        throw RecordError(fmt::format("{}:{}:{}", file, line.number, at + 1),
                          fmt::format("{} has a sign between thousands", Quoted(cell)),
                          "numbers such as 1234.5 or 1234,5: which sign is which is not guessed");
      }
    }
  }
  const TextLine last = lines.empty() ? TextLine{"", 0, 1} : lines.back();
  throw RecordError(fmt::format("{}:{}:1", file, last.number),
                    lines.empty() ? std::string("the file is empty")
                                  : fmt::format("{} is no row of a table", Quoted(last.text)),
                    "rows of numbers with commas, semicolons, tabs, bars or blanks between them");
}

}  // namespace

void DemandShort(std::string_view line, const std::string& file, std::size_t number) {
  if (line.size() <= kMostLine_bytes) return;
  throw RecordError(fmt::format("{}:{}:{}", file, number, kMostLine_bytes + 1),
                    fmt::format("the line has {} bytes", line.size()),
                    fmt::format("lines of at most {}", kMostLine_bytes));
}

std::vector<std::pair<std::string, std::size_t>> CellsOf(std::string_view line, char separator,
                                                         bool ends_with_separator) {
  if (ends_with_separator && line.ends_with(separator)) line.remove_suffix(1);
  std::vector<std::pair<std::string, std::size_t>> cells;
  if (separator == ' ') {
    for (std::size_t at = 0; at < line.size();) {
      if (line[at] == ' ' || line[at] == '\t') {
        ++at;
        continue;
      }
      const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
      cells.emplace_back(line.substr(at, end - at), at);
      at = end;
    }
    return cells;
  }
  for (Cell& cell : SplitCells(line, separator))
    cells.emplace_back(std::move(cell.text), static_cast<std::size_t>(cell.column - 1));
  return cells;
}

std::optional<double> CsvNumber(std::string_view cell, bool decimal_comma) {
  cell = Trim(cell);
  if (cell.starts_with('+') && cell.size() > 1 && cell[1] != '-') cell.remove_prefix(1);
  std::string changed;
  if (decimal_comma) {
    if (cell.find('.') != cell.npos) return std::nullopt;
    changed = cell;
    std::ranges::replace(changed, ',', '.');
    cell = changed;
  }
  double value{};
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<double> ClockSeconds(std::string_view cell) {
  cell = Trim(cell);
  double days = 0.0;
  const auto number = [](std::string_view text) -> std::optional<int> {
    int value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc() || end != text.data() + text.size() || value < 0)
      return std::nullopt;
    return value;
  };
  const auto day_of = [&](std::string_view y, std::string_view m, std::string_view d) -> bool {
    const auto year = number(y);
    const auto month = number(m);
    const auto day = number(d);
    if (!year || !month || !day || y.size() != 4) return false;
    const std::chrono::year_month_day date{std::chrono::year(*year),
                                           std::chrono::month(static_cast<unsigned>(*month)),
                                           std::chrono::day(static_cast<unsigned>(*day))};
    if (!date.ok()) return false;
    days = static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
    return true;
  };
  // With the year first there is one reading, whatever the sign behind it.
  const bool by_year = cell.size() > 11 && (cell[4] == '-' || cell[4] == '/') && cell[7] == cell[4];
  if (by_year && (cell[10] == 'T' || cell[10] == ' ')) {
    if (!day_of(cell.substr(0, 4), cell.substr(5, 2), cell.substr(8, 2))) return std::nullopt;
    cell.remove_prefix(11);
  } else if (cell.size() > 11 && cell[2] == '.' && cell[5] == '.' && cell[10] == ' ') {
    if (!day_of(cell.substr(6, 4), cell.substr(3, 2), cell.substr(0, 2))) return std::nullopt;
    cell.remove_prefix(11);
  }
  if (cell.ends_with('Z')) cell.remove_suffix(1);
  const std::size_t first = cell.find(':');
  const std::size_t second = first == cell.npos ? cell.npos : cell.find(':', first + 1);
  if (second == cell.npos) return std::nullopt;
  const auto hours = number(cell.substr(0, first));
  const auto minutes = number(cell.substr(first + 1, second - first - 1));
  std::string seconds_text(cell.substr(second + 1));
  std::ranges::replace(seconds_text, ',', '.');
  const std::optional<double> seconds = CsvNumber(seconds_text, false);
  if (!hours || !minutes || !seconds || *hours > 23 || *minutes > 59 || *seconds < 0.0 || *seconds >= 61.0)
    return std::nullopt;
  return days * 86400.0 + *hours * 3600.0 + *minutes * 60.0 + *seconds;
}

CsvDialect FindCsvDialect(std::string_view text, const std::string& file) {
  std::vector<TextLine> lines = FirstLines(text, file);
  std::optional<char> said;
  if (!lines.empty() && (lines[0].text.starts_with("sep=") || lines[0].text.starts_with("Sep=")) &&
      lines[0].text.size() > 4) {
    said = lines[0].text[4];
    lines.erase(lines.begin());
  }
  std::vector<Reading> readings;
  for (const char separator : kSeparators) {
    if (said && separator != *said) continue;
    for (const bool decimal_comma : {false, true}) {
      if (decimal_comma && separator == ',' && text.find('"') == text.npos) continue;
      std::optional<Reading> reading = Read(lines, separator, decimal_comma);
      if (!reading) continue;
      // Without a decimal sign in any cell both are one reading.
      const bool same = std::ranges::any_of(readings, [&](const Reading& other) {
        const bool one_column = other.dialect.names.size() == 1 && reading->dialect.names.size() == 1;
        return other.dialect.first_row == reading->dialect.first_row &&
               (other.dialect.separator == separator ||
                (one_column && other.dialect.decimal_comma == decimal_comma));
      });
      if (!same) readings.push_back(std::move(*reading));
    }
  }
  if (readings.empty()) RefuseNone(lines, file);
  if (std::ranges::any_of(readings, &Reading::header_fits))
    std::erase_if(readings, [](const Reading& reading) { return !reading.header_fits; });
  // A single column beside a reading with several is what any text without that separator gives.
  if (std::ranges::any_of(
          readings, [](const Reading& r) { return r.dialect.names.size() > 1 && r.dialect.has_header; }))
    std::erase_if(readings, [](const Reading& r) { return r.dialect.names.size() == 1; });
  // Columns of one width that blanks or tabs separate alike.
  if (readings.size() > 1 && readings.back().dialect.separator == ' ') readings.pop_back();
  // That begins earlier: the other took rows for a preamble.
  const auto earliest =
      std::ranges::min(readings, {}, [](const Reading& r) { return r.dialect.first_row; }).dialect.first_row;
  std::erase_if(readings, [&](const Reading& r) { return r.dialect.first_row > earliest; });
  if (readings.size() > 1) {
    std::string_view rest = text.substr(readings[0].dialect.first_row);
    const std::string_view row = TakeLine(rest).text;
    throw RecordError(fmt::format("{}:{}:1", file, readings[0].dialect.first_line),
                      fmt::format("{} can be read in two ways, {}, or {}", Quoted(row),
                                  Shown(readings[0].dialect, row), Shown(readings[1].dialect, row)),
                      "a header with a name for each cell, or a first line such as sep=;");
  }
  return std::move(readings.front().dialect);
}

std::vector<std::string> WordsOf(const CsvDialect& dialect) {
  std::vector<std::string> words{SeparatorName(dialect.separator),
                                 dialect.decimal_comma ? "decimal comma" : "decimal point",
                                 fmt::format("values from line {} on", dialect.first_line)};
  if (!dialect.has_header) words.emplace_back("no header");
  return words;
}

}  // namespace strainwave::daq
