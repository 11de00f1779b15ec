// SPDX-License-Identifier: Apache-2.0
#include "daq/csv_form.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <tuple>
#include <vector>

#include "daq/csv_text.h"
#include "daq/direction_words.h"
#include "daq/record_error.h"
#include "daq/record_limits.h"
#include "daq/record_rules.h"

namespace strainwave::daq {
namespace {

constexpr std::string_view kSeparators = ",;\t| ";

std::string_view NameOf(char separator) {
  switch (separator) {
    case ',':
      return "commas";
    case ';':
      return "semicolons";
    case '\t':
      return "tabs";
    case '|':
      return "bars";
    case ' ':
      return "blanks";
    default:
      return "other signs";
  }
}

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// "12,5", "-0,025", "1,5e-3": one comma after digits, and a number when a point stands in its place.
bool HasDecimalComma(std::string_view cell) {
  const std::size_t comma = cell.find(',');
  if (comma == cell.npos || comma == 0 || comma + 1 == cell.size()) return false;
  if (!IsDigit(cell[comma - 1]) || !IsDigit(cell[comma + 1]) || cell.find('.') != cell.npos) return false;
  std::string with_point(cell);
  with_point[comma] = '.';
  return NumberFromText(with_point).has_value();
}

// "1,500" may be thousands: one to three digits, not 0 alone, then three.
bool MayBeThousands(std::string_view cell) {
  if (cell.starts_with('-') || cell.starts_with('+')) cell.remove_prefix(1);
  const std::size_t comma = cell.find(',');
  return comma <= 3 && cell[0] != '0' && cell.size() == comma + 4 &&
         std::all_of(cell.begin() + 1 + static_cast<std::ptrdiff_t>(comma), cell.end(), IsDigit);
}

bool IsValue(std::string_view text) {
  return NumberFromText(text).has_value() || DirectionOf(text).has_value();
}

// Whatever the separator and the decimal sign.
bool HoldsOnlyValues(std::string_view line) {
  bool any = false;
  while (!line.empty()) {
    const std::size_t end = std::min(line.find_first_of(",;\t| \""), line.size());
    if (end > 0 && !IsValue(line.substr(0, end))) return false;
    any = any || end > 0;
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return any;
}

// Blanks between cells are as many as it takes to align them. A line that is too long is refused later, and
// not taken to pieces here.
std::vector<Cell> Cells(std::string_view line, char separator) {
  if (line.size() > kMostLine_bytes) return {};
  if (separator != ' ') return SplitCells(line, separator);
  std::string blanks(line);
  std::ranges::replace(blanks, '\t', ' ');
  std::vector<Cell> cells = SplitCells(blanks, ' ');
  std::erase_if(cells, [](const Cell& cell) { return cell.text.empty(); });
  return cells;
}

struct PlacedLine {
  std::string_view text;
  int number{};
};

class FormReader {
 public:
  FormReader(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  CsvForm Read() {
    FindLines();
    if (header_.text.empty()) return {',', text_, std::move(plain_)};
    FindSeparator();
    for (const PlacedLine& line : metadata_) PlainMetadata(line.text);
    PlainDecimals();
    if (separator_ == ' ') {
      PlainBlanks();
      separator_ = '\t';
    }
    return {separator_, text_, std::move(plain_)};
  }

 private:
  [[noreturn]] void Refuse(int line, int column, std::string what, std::string expected) const {
    throw RecordError(fmt::format("{}:{}:{}", file_, line, column), std::move(what), std::move(expected));
  }

  // Most files need no copy.
  void Put(const char& at, char c) {
    if (plain_.empty() && at == c) return;
    if (plain_.empty()) plain_ = text_;
    plain_[static_cast<std::size_t>(&at - text_.data())] = c;
  }
  void Blank(std::string_view part) {
    for (const char& c : part) Put(c, ' ');
  }

  // Metadata, the header and the first row.
  void FindLines() {
    std::string_view rest = text_;
    PlacedLine first;
    for (int number = 1; !rest.empty() && first.text.empty(); ++number) {
      const std::string_view line = TakeLine(rest).text;
      const std::string_view content = Trim(line);
      if (number == 1 && TakeSeparatorLine(line)) continue;
      if (content.find_first_not_of(",;|\t ") == content.npos) {
        Blank(line);
      } else if (content.starts_with('#') || content.starts_with("\"#")) {
        metadata_.push_back({line, number});
      } else {
        first = {line, number};
      }
    }
    if (first.text.empty()) return;
    if (!HoldsOnlyValues(first.text)) {
      header_ = first;
      rows_ = rest;
      while (!rest.empty() && Trim(first_row_).empty()) first_row_ = TakeLine(rest).text;
      return;
    }
    first_row_ = first.text;
    if (metadata_.empty() || metadata_.back().text.find(':') != std::string_view::npos) RefuseMissingHeader();
    is_commented_ = true;
    header_ = metadata_.back();
    metadata_.pop_back();
    const std::size_t sign = header_.text.find('#');
    Blank(header_.text.substr(0, sign + 1));
    header_.text.remove_prefix(sign + 1);
    rows_ = text_.substr(static_cast<std::size_t>(first.text.data() - text_.data()));
  }

  // "sep=;", which spreadsheets take as a command and do not show.
  bool TakeSeparatorLine(std::string_view line) {
    std::string_view content = line;
    if (content.size() > 1 && content.front() == '"' && content.back() == '"') {
      content = content.substr(1, content.size() - 2);
    }
    if (content.size() < 4 || content[3] != '=' || std::tolower(content[0]) != 's' ||
        std::tolower(content[1]) != 'e' || std::tolower(content[2]) != 'p') {
      return false;
    }
    if (content.size() != 5 || kSeparators.find(content[4]) == kSeparators.npos) {
      Refuse(1, 1, Quoted(line) + " names no separator",
             "a comma, a semicolon, a tab, a bar or a blank after 'sep='");
    }
    said_separator_ = content[4];
    Blank(line);
    return true;
  }

  static bool IsKnownToAnyKind(std::string_view name) {
    constexpr RecordKind::Value kKinds[] = {RecordKind::kTransmissionError,
                                            RecordKind::kHysteresis,
                                            RecordKind::kMotion,
                                            RecordKind::kVibration,
                                            RecordKind::kMotor,
                                            RecordKind::kJoints,
                                            RecordKind::kHistory};
    return std::ranges::any_of(kKinds, [name](RecordKind kind) { return IsKnownColumn(kind, name); });
  }

  // Names that a record has decide; then that the first row has as many cells.
  void FindSeparator() {
    const auto merit = [&](char separator) {
      const std::vector<Cell> names = Cells(header_.text, separator);
      const auto known =
          std::ranges::count_if(names, [](const Cell& cell) { return IsKnownToAnyKind(cell.text); });
      const bool fits = names.size() > 1 && names.size() == Cells(first_row_, separator).size();
      return std::tuple(known, fits);
    };
    char best = kSeparators.front();
    for (const char separator : kSeparators) {
      if (merit(separator) > merit(best)) best = separator;
    }
    separator_ = said_separator_.value_or(best);
    if (Cells(header_.text, separator_).size() == 1 && Cells(header_.text, best).size() > 1) {
      Refuse(1, 1, fmt::format("'sep=' says {}, the header has {}", NameOf(separator_), NameOf(best)),
             "the same");
    }
    if (is_commented_ && std::get<0>(merit(separator_)) == 0) RefuseMissingHeader();
    CheckFirstRow();
  }

  [[noreturn]] void RefuseMissingHeader() const {
    Refuse(LineOf(first_row_), 1, "the header line is missing",
           "the names of the columns, with commas between");
  }

  int LineOf(std::string_view part) const {
    return static_cast<int>(std::count(text_.data(), part.data(), '\n')) + 1;
  }

  void CheckFirstRow() const {
    const std::vector<Cell> values = Cells(first_row_, separator_);
    const std::size_t width = Cells(header_.text, separator_).size();
    for (const char other : kSeparators) {
      if (values.size() > 1 || width <= 1 || Cells(first_row_, other).size() != width) continue;
      Refuse(LineOf(first_row_), 1,
             fmt::format("the cells have {} between, the names in the header {}", NameOf(other),
                         NameOf(separator_)),
             "the same");
    }
    const bool are_halves = std::ranges::all_of(values, [](const Cell& cell) {
      const std::string_view text = cell.text;
      return !text.empty() && text.find_first_not_of("+-0123456789eE") == text.npos;
    });
    if (separator_ == ',' && are_halves && values.size() > width) {
      Refuse(LineOf(first_row_), 1, "the numbers have a decimal comma, and the cells a comma between",
             "decimal points, or semicolons between the cells");
    }
  }

  // A spreadsheet fills each line up to the width of the table, and quotes a text with a separator in it.
  void PlainMetadata(std::string_view line) {
    const auto separators = static_cast<std::size_t>(std::count(line.begin(), line.end(), separator_));
    const std::string filling = {separator_, ' ', '\t'};
    const std::size_t end = line.find_last_not_of(filling) + 1;
    const std::string_view filled = line.substr(end);
    const std::size_t width = Cells(header_.text, separator_).size();
    const bool is_quoted = Trim(line).starts_with('"') && line.substr(0, end).ends_with('"');
    if (is_quoted || (separators + 1 == width &&
                      std::ranges::count(filled, separator_) + 1 == static_cast<std::ptrdiff_t>(width))) {
      Blank(filled);
    }
    if (!is_quoted) return;
    Put(line[line.find('"')], ' ');
    Put(line[end - 1], ' ');
  }

  void PlainDecimals() {
    // Cells without a comma inside cannot have a decimal one, which saves the walk through the usual file.
    const bool may_have = rows_.find(separator_ == ',' ? '"' : ',') != rows_.npos;
    if (!may_have) return;
    struct Place {
      int line{};
      int column{};
      std::string text;
    };
    std::optional<Place> comma;
    std::optional<Place> point;
    bool is_proved = false;
    int number = LineOf(rows_) - 1;
    for (std::string_view rest = rows_; !rest.empty();) {
      ++number;
      const std::string_view line = TakeLine(rest).text;
      for (const Cell& cell : Cells(line, separator_)) {
        if (HasDecimalComma(cell.text)) {
          is_proved = is_proved || !MayBeThousands(cell.text);
          if (!comma) comma = Place{number, cell.column, cell.text};
          Put(line[line.find(',', static_cast<std::size_t>(cell.column) - 1)], '.');
        } else if (!point && cell.text.find('.') != cell.text.npos && NumberFromText(cell.text)) {
          point = Place{number, cell.column, cell.text};
        }
      }
    }
    if (!comma) return;
    if (point) {
      Refuse(comma->line, comma->column,
             fmt::format("{} has a decimal comma, {} in line {} a point", Quoted(comma->text),
                         Quoted(point->text), point->line),
             "one of them in a file, and nothing between thousands");
    }
    if (!is_proved) {
      Refuse(comma->line, comma->column,
             fmt::format("{} can be a decimal comma, or a comma between thousands", Quoted(comma->text)),
             "a decimal point, and nothing between thousands");
    }
    for (const PlacedLine& line : metadata_) {
      const std::string_view value =
          Trim(line.text.substr(std::min(line.text.find(':') + 1, line.text.size())));
      if (HasDecimalComma(value)) Put(value[value.find(',')], '.');
    }
  }

  // The first blank between two cells becomes a tab; the others are blanks around a cell.
  void PlainBlanks() {
    const auto put_tabs = [this](std::string_view line) {
      const std::vector<Cell> cells = Cells(line, ' ');
      for (const char& c : line) {
        if (c == '\t') Put(c, ' ');
      }
      for (std::size_t i = 1; i < cells.size(); ++i)
        Put(line[static_cast<std::size_t>(cells[i].column) - 2], '\t');
    };
    put_tabs(header_.text);
    for (std::string_view rest = rows_; !rest.empty();) put_tabs(TakeLine(rest).text);
  }

  std::string_view text_;
  const std::string& file_;
  std::string plain_;
  std::vector<PlacedLine> metadata_;
  PlacedLine header_;
  std::string_view first_row_;
  std::string_view rows_;
  bool is_commented_ = false;  // the header, behind '#'
  std::optional<char> said_separator_;
  char separator_ = ',';
};

}  // namespace

CsvForm PlainCsvForm(std::string_view text, const std::string& file) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  if (const std::optional<std::size_t> bad = FindNonTextByte(text)) {
    const std::string_view before = text.substr(0, *bad);
    const auto line = std::count(before.begin(), before.end(), '\n') + 1;
    const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 is 0
    const bool is_utf16 = text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF");
    throw RecordError(fmt::format("{}:{}:{}", file, line, *bad - line_start + 1),
                      is_utf16
                          ? "the text is UTF-16"
                          : fmt::format("byte 0x{:02X} is not text", static_cast<unsigned char>(text[*bad])),
                      "a record as CSV in UTF-8, or as HDF5");
  }
  return FormReader(text, file).Read();
}

}  // namespace strainwave::daq
