// SPDX-License-Identifier: Apache-2.0
#include "daq/csv_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <limits>
#include <map>
#include <tuple>

#include "daq/csv_findings.h"
#include "daq/csv_form.h"
#include "daq/csv_text.h"
#include "daq/direction_words.h"
#include "daq/record_error.h"
#include "daq/record_limits.h"
#include "daq/record_rules.h"
#include "daq/whole_file.h"

namespace strainwave::daq {
namespace {

class CsvReader {
 public:
  CsvReader(const CsvForm& form, const std::string& file) : rest_(form.text()), separator_(form.separator()) {
    record_.source.file = file;
  }

  Record Read() {
    ReadMetadata();
    ReadHeader();
    ReadRows();
    TakeColumns();
    ApplyRules();
    ThrowIfAnyFound();
    return std::move(record_);
  }

 private:
  void Add(Place place, std::string what, std::string expected) {
    findings_.push_back({place, std::move(what), std::move(expected)});
    if (findings_.size() >= kMostFindings) ThrowIfAnyFound();
  }

  [[noreturn]] void Refuse(Place place, std::string what, std::string expected) {
    findings_.push_back({place, std::move(what), std::move(expected)});
    ThrowIfAnyFound();
    std::abort();  // something was found
  }

  void ThrowIfAnyFound() {
    if (findings_.empty()) return;
    std::stable_sort(findings_.begin(), findings_.end(), [](const PlacedFinding& a, const PlacedFinding& b) {
      return std::tie(a.place.line, a.place.column) < std::tie(b.place.line, b.place.column);
    });
    std::vector<Finding> placed;
    for (PlacedFinding& finding : findings_) {
      placed.push_back(
          {fmt::format("{}:{}:{}", record_.source.file, finding.place.line, finding.place.column),
           std::move(finding.what), std::move(finding.expected)});
    }
    throw RecordError(std::move(placed));
  }

  Line NextLine() {
    ++line_number_;
    const Line line = TakeLine(rest_);
    if (line.text.size() > kMostLine_bytes) {
      Refuse({line_number_, static_cast<int>(kMostLine_bytes) + 1},
             fmt::format("the line has {} bytes", line.text.size()),
             fmt::format("lines of at most {}", kMostLine_bytes));
    }
    return line;
  }

  // Stops after the header line, which it leaves in `header_`.
  void ReadMetadata() {
    if (rest_.empty()) {
      Add({1, 1}, "the file is empty", "lines '# key: value', a header line, and numbers");
      ThrowIfAnyFound();
    }
    while (!rest_.empty()) {
      const Line line = NextLine();
      const std::string_view text = Trim(line.text);
      if (text.empty()) continue;
      if (!text.starts_with('#')) {
        header_ = line.text;
        header_line_ = line_number_;
        break;
      }
      ReadMetadataLine(line.text);
    }
    CheckKind();
    if (header_line_ == 0) {
      Add({line_number_ + 1, 1}, "the header line is missing",
          "the names of the columns, with commas between");
      ThrowIfAnyFound();
    }
  }

  void ReadMetadataLine(std::string_view line) {
    const auto column_of = [line](std::string_view part) {
      return static_cast<int>(part.data() - line.data()) + 1;
    };
    const std::string_view content = Trim(line.substr(line.find('#') + 1));
    if (content.empty()) return;
    const std::size_t colon = content.find(':');
    const std::string_view key = Trim(content.substr(0, colon));
    if (colon == content.npos || key.empty()) {
      Add({line_number_, column_of(content)}, Quoted(content) + " is not metadata", "'# key: value'");
      return;
    }
    const std::string_view value = Trim(content.substr(colon + 1));
    const Place place{line_number_, value.empty() ? static_cast<int>(line.size()) + 1 : column_of(value)};
    const auto [earlier, is_new] = metadata_places_.emplace(key, place);
    if (!is_new) {
      Add({line_number_, column_of(key)}, fmt::format("metadata {} is doubled", Quoted(key)),
          fmt::format("it once, as in line {}", earlier->second.line));
      return;
    }
    if (metadata_places_.size() > kMostMetadata) {
      Refuse({line_number_, 1}, fmt::format("there are more than {} lines of metadata", kMostMetadata),
             "fewer, and values in columns");
    }
    if (key == "kind") {
      record_.kind = RecordKind::Named(value);
    } else {
      record_.metadata.emplace_back(key, value);
    }
  }

  void CheckKind() {
    if (record_.kind != RecordKind::kUnknown) return;
    const auto said = metadata_places_.find("kind");
    if (said == metadata_places_.end()) {
      Add({1, 1}, "metadata 'kind' is missing", fmt::format("'# kind: ' and {}", kKnownKinds));
    } else {
      Add(said->second, "kind is " + Quoted(record_.kind.name()), std::string(kKnownKinds));
    }
  }

  void ReadHeader() {
    std::vector<Cell> cells = SplitCells(header_, separator_);
    if (cells.size() > kMostColumns) {
      Refuse({header_line_, cells[kMostColumns].column},
             fmt::format("the header has {} columns", cells.size()),
             fmt::format("at most {}: a record a part of the channels", kMostColumns));
    }
    for (Cell& cell : cells) {
      const Place place{header_line_, cell.column};
      if (cell.text.empty()) {
        Add(place, fmt::format("column {} has no name", columns_.size() + 1), "a name such as torque_Nm");
      } else if (std::any_of(columns_.begin(), columns_.end(),
                             [&](const CsvColumn& column) { return column.name == cell.text; })) {
        Add(place, fmt::format("column {} is doubled", Quoted(cell.text)), "each column once");
      }
      const bool is_known = IsKnownColumn(record_.kind, cell.text);
      columns_.push_back({.name = std::move(cell.text),
                          .is_direction = false,
                          .is_known = is_known,
                          .numbers = {},
                          .directions = {},
                          .bad_cells = {},
                          .bad_rows = {}});
      columns_.back().is_direction = is_known && columns_.back().name == "direction";
    }
    // Without a kind or with a broken header nothing below can be judged.
    ThrowIfAnyFound();
    record_.source.first_data_line = header_line_ + 1;
    rows_text_ = rest_;
    const auto lines = static_cast<std::size_t>(std::count(rest_.begin(), rest_.end(), '\n'));
    // Each row has two bytes a cell at least, whatever the number of blank lines.
    const std::size_t rows = std::min(lines + 1, rest_.size() / (2 * columns_.size()) + 1);
    for (CsvColumn& column : columns_) {
      if (!column.is_direction) column.numbers.reserve(rows);
    }
  }

  void ReadRows() {
    std::size_t blank_lines = 0;
    while (!rest_.empty() && bad_cells_ < kMostBadCells) {
      const Line line = NextLine();
      if (Trim(line.text).empty()) {
        ++blank_lines;
        continue;
      }
      for (; blank_lines > 0; --blank_lines) {
        Add({line_number_ - static_cast<int>(blank_lines), 1}, "the line is blank",
            fmt::format("{} cells, as in the header", columns_.size()));
        for (std::size_t c = 0; c < columns_.size(); ++c) PushNothing(columns_[c]);
        ++row_;
      }
      if (!ReadRowFast(line.text)) {
        if (IsCutOffLog(line)) break;
        ReadRowWithCare(line);
      }
      ++row_;
      if (row_ * columns_.size() > kMostValues) {
        Refuse({line_number_, 1}, fmt::format("the record has more than {} values", kMostValues),
               "fewer: a file a part of the time");
      }
    }
    if (row_ == 0) Add({line_number_ + 1, 1}, "no rows follow the header", "at least one line of numbers");
  }

  // A logger that was killed leaves half a line; what an axis did before is worth having without it.
  bool IsCutOffLog(const Line& line) {
    if (record_.kind != RecordKind::kMotion || line.has_end || row_ == 0) return false;
    const std::vector<Cell> cells = SplitCells(line.text, separator_);
    const bool whole = cells.size() == columns_.size() && NumberFromText(cells.back().text);
    if (whole || cells.size() > columns_.size()) return false;
    record_.notes.push_back({line_number_, fmt::format("line {} is left out: it is cut off", line_number_)});
    return true;
  }

  // Rows of plain numbers and directions, the usual case, without a copy of any cell. Leaves the columns as
  // they were when it meets anything else.
  bool ReadRowFast(std::string_view line) {
    const char* at = line.data();
    const char* const end = line.data() + line.size();
    std::size_t done = 0;
    for (; done < columns_.size(); ++done) {
      CsvColumn& column = columns_[done];
      if (done > 0) {
        if (at == end || *at != separator_) break;
        ++at;
      }
      if (column.is_direction) {
        const std::string_view left(at, static_cast<std::size_t>(end - at));
        const bool ccw = left.starts_with("ccw");
        if (!ccw && !left.starts_with("cw")) break;
        column.directions.push_back(ccw ? Direction::kCounterClockwise : Direction::kClockwise);
        at += ccw ? 3 : 2;
      } else {
        double value{};
        const std::from_chars_result parsed = std::from_chars(at, end, value);
        if (parsed.ec != std::errc{}) break;
        column.numbers.push_back(value);
        at = parsed.ptr;
      }
    }
    if (done == columns_.size() && at == end) {
      for (CsvColumn& column : columns_) ++column.good_numbers;
      return true;
    }
    for (CsvColumn& column : columns_) {
      if (column.numbers.size() > row_) column.numbers.pop_back();
      if (column.directions.size() > row_) column.directions.pop_back();
    }
    return false;
  }

  void ReadRowWithCare(const Line& line) {
    if (Trim(line.text).starts_with('#')) {
      Add({line_number_, 1}, "metadata after the header line", "metadata before the header line");
      for (CsvColumn& column : columns_) PushNothing(column);
      return;
    }
    const std::vector<Cell> cells = SplitCells(line.text, separator_);
    // A last line without an end may have been cut; an empty last cell then is one that was about to come.
    const bool may_be_cut = !line.has_end;
    const std::size_t whole = may_be_cut && cells.back().text.empty() ? cells.size() - 1 : cells.size();
    if (whole == columns_.size()) {
      for (std::size_t c = 0; c < columns_.size(); ++c) ReadCell(cells[c], columns_[c]);
      return;
    }
    // Which cell belongs to which column is anybody's guess, so none is taken.
    for (CsvColumn& column : columns_) PushNothing(column);
    const int end_column = static_cast<int>(line.text.size()) + 1;
    if (may_be_cut && whole < columns_.size()) {
      Add({line_number_, end_column},
          fmt::format("the last line is cut off after {} of {} cells", whole, columns_.size()),
          "a whole line");
    } else {
      Add({line_number_, cells.size() > columns_.size() ? cells[columns_.size()].column : end_column},
          fmt::format("the line has {} {}", cells.size(), cells.size() == 1 ? "cell" : "cells"),
          fmt::format("{}, as in the header", columns_.size()));
    }
  }

  void ReadCell(const Cell& cell, CsvColumn& column) {
    if (column.is_direction) {
      if (const std::optional<Direction> direction = DirectionOf(cell.text)) {
        column.directions.push_back(*direction);
        return;
      }
    } else if (const std::optional<double> number = NumberFromText(cell.text)) {
      column.numbers.push_back(*number);
      ++column.good_numbers;
      return;
    }
    PushNothing(column);
    if (column.bad_cells.size() >= kMostBadCells) return;
    if (column.is_known) ++bad_cells_;
    column.bad_cells.push_back({{line_number_, cell.column},
                                cell.text.empty() ? column.name + " is empty"
                                                  : fmt::format("{} is {}", column.name, Quoted(cell.text)),
                                column.is_direction ? std::string(kDirectionWords) : "a number"});
  }

  // Keeps the columns of one length where a cell has no value; the row is marked, so that the rules do not
  // complain a second time.
  void PushNothing(CsvColumn& column) {
    if (column.is_direction) {
      column.directions.push_back(Direction::kClockwise);
    } else {
      column.numbers.push_back(std::numeric_limits<double>::quiet_NaN());
    }
    if (column.bad_rows.size() < kMostBadCells) column.bad_rows.insert(row_);
  }

  void TakeColumns() {
    for (CsvColumn& column : columns_) {
      const bool is_channel = TakesFurtherChannels(record_.kind) && column.good_numbers > 0;
      if (!column.bad_cells.empty() && !column.is_known && !is_channel) {
        const int line = column.bad_cells.front().place.line;
        record_.notes.push_back(
            {line, fmt::format("column {} is left out: line {} is not a number", Quoted(column.name), line)});
        continue;
      }
      findings_.insert(findings_.end(), column.bad_cells.begin(), column.bad_cells.end());
      Column& taken = record_.columns.emplace_back();
      taken.name = column.name;
      if (column.is_direction) {
        taken.values = std::move(column.directions);
      } else {
        taken.values = std::move(column.numbers);
      }
    }
  }

  void ApplyRules() {
    // With no rows, that was said already; what else is missing is worth saying.
    for (const RuleBreak& rule_break : CheckRecord(record_)) {
      const RecordPart& part = rule_break.part;
      const auto column = std::find_if(columns_.begin(), columns_.end(), [&](const CsvColumn& candidate) {
        return candidate.name == part.name;
      });
      switch (part.level) {
        case RecordPart::Level::kRecord:
          if (row_ > 0 || rule_break.what != "the record has no rows") {
            Add({header_line_, 1}, rule_break.what, rule_break.expected);
          }
          break;
        case RecordPart::Level::kKind:
          break;  // said by CheckKind, with its line
        case RecordPart::Level::kMetadata:
          Add(metadata_places_.find(part.name)->second, rule_break.what, rule_break.expected);
          break;
        case RecordPart::Level::kColumn:
          Add({header_line_, 1}, rule_break.what, rule_break.expected);
          break;
        case RecordPart::Level::kCell:
          if (column->bad_rows.contains(part.row)) break;
          Add(PlaceOfCell(part.row, static_cast<std::size_t>(column - columns_.begin())), rule_break.what,
              rule_break.expected);
          break;
      }
    }
  }

  // Looked up again from the text: only messages need it.
  Place PlaceOfCell(std::size_t row, std::size_t column) const {
    std::string_view rest = rows_text_;
    for (std::size_t skipped = 0; skipped < row; ++skipped) TakeLine(rest);
    const std::vector<Cell> cells = SplitCells(TakeLine(rest).text, separator_);
    return {record_.source.first_data_line + static_cast<int>(row), cells[column].column};
  }

  std::string_view rest_;
  char separator_;
  std::string_view header_;
  std::string_view rows_text_;
  int line_number_ = 0;
  int header_line_ = 0;
  std::size_t row_ = 0;
  std::size_t bad_cells_ = 0;
  std::map<std::string, Place, std::less<>> metadata_places_;
  std::vector<CsvColumn> columns_;
  std::vector<PlacedFinding> findings_;
  Record record_;
};

}  // namespace

Record ReadCsvRecord(const std::filesystem::path& path) {
  return ParseCsvRecord(ReadWholeFile(path), path.string());
}

Record ParseCsvRecord(std::string_view text, const std::string& file) {
  return CsvReader(PlainCsvForm(text, file), file).Read();
}

}  // namespace strainwave::daq
