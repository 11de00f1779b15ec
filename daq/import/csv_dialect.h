// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// How a text of columns is to be read: separator, decimal sign, where the table begins.
namespace strainwave::daq {

enum class CellKind { kNumber, kClock, kWord };

struct CsvDialect {
  char separator{','};
  bool decimal_comma{};
  bool ends_with_separator{};      // each row does
  std::size_t first_row{};         // byte at which the first row of values begins
  int first_line{};                // its line, from 1
  std::vector<std::string> names;  // one a column; "column 1" where there is no header
  std::vector<std::string> units;  // one a column; empty where none is said
  std::vector<CellKind> kinds;     // one a column
  bool has_header{};
  std::vector<std::pair<std::string, std::string>> preamble;  // of the lines before it
};

/// The one way in which the text can be read.
/// @throws RecordError where there is none, with the cause, or where there are two, with both.
CsvDialect FindCsvDialect(std::string_view text, const std::string& file);

/// @throws RecordError for a line of more than `kMostLine_bytes`.
void DemandShort(std::string_view line, const std::string& file, std::size_t number);

/// "semicolons, decimal comma, header in line 4", for people.
std::vector<std::string> WordsOf(const CsvDialect& dialect);

/// The cells of a line; blanks between them count once where they are the separator.
std::vector<std::pair<std::string, std::size_t>> CellsOf(std::string_view line, char separator,
                                                         bool ends_with_separator);

/// A number with that decimal sign; nothing for another text, and for numbers that are not finite.
std::optional<double> CsvNumber(std::string_view cell, bool decimal_comma);

/// Seconds of "12:34:56.789", of the day, or of "2026-11-29T12:34:56.789", "2026/11/29 12:34:56" and
/// "29.11.2026 12:34:56", since 1970 in the clock's own zone.
std::optional<double> ClockSeconds(std::string_view cell);

}  // namespace strainwave::daq
