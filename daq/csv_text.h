// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The letters of a CSV file: lines, cells, and what a message says about them. Knows nothing of records.
namespace strainwave::daq {

/// One cell, without the blanks around it.
struct Cell {
  std::string text;
  int column{};  // 1-based byte column where its text starts
};

/// Takes the next line off `rest`, without LF or CR LF. `has_end` tells a line from a last one that stops
/// short.
struct Line {
  std::string_view text;
  bool has_end{};
};
Line TakeLine(std::string_view& rest);

/// `text` without blanks and tabs at both ends, nor the no-break and thin spaces that come with copied text.
std::string_view Trim(std::string_view text);

/// Splits at the separators; a cell in double quotes may hold them, and a quote doubled.
std::vector<Cell> SplitCells(std::string_view line, char separator);

/// Where a text stops being one: the offset of the first byte that is not UTF-8, or that is a control
/// character other than tab and line end; nothing for a text.
std::optional<std::size_t> FindNonTextByte(std::string_view text);

/// `text` in single quotes, cut to 40 bytes, for a message.
std::string Quoted(std::string_view text);

}  // namespace strainwave::daq
