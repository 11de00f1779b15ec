// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <stdexcept>

#include "daq/csv_record.h"
#include "daq/csv_text.h"
#include "daq/whole_file.h"

namespace strainwave::daq {
namespace {

void DemandPlain(std::string_view what, std::string_view text, std::string_view forbidden) {
  const bool plain = text == Trim(text) && text.find_first_of("\r\n") == text.npos &&
                     text.find_first_of(forbidden) == text.npos && !FindNonTextByte(text);
  if (plain) return;
  throw std::invalid_argument(fmt::format("{} {} cannot stand in a CSV record", what, Quoted(text)));
}

void DemandWritable(const Record& record) {
  DemandPlain("kind", record.kind.name(), "");
  for (auto entry = record.metadata.begin(); entry != record.metadata.end(); ++entry) {
    const auto& [key, value] = *entry;
    DemandPlain("metadata key", key, ":");
    DemandPlain("metadata value", value, "");
    const bool is_doubled = std::any_of(record.metadata.begin(), entry,
                                        [&](const auto& earlier) { return earlier.first == entry->first; });
    if (key.empty() || key == "kind" || is_doubled) {
      throw std::invalid_argument(fmt::format("metadata key '{}' is empty, doubled or 'kind'", key));
    }
  }
  for (const Column& column : record.columns) {
    DemandPlain("column name", column.name, ",\"");
    if (column.name.empty() || column.name.starts_with('#') || record.FindColumn(column.name) != &column) {
      throw std::invalid_argument(
          fmt::format("column name '{}' is empty, doubled or a comment", column.name));
    }
    if (column.size() != record.rows()) {
      throw std::invalid_argument(
          fmt::format("column '{}' has {} rows, not {}", column.name, column.size(), record.rows()));
    }
  }
  if (record.rows() == 0) throw std::invalid_argument("the record has no rows");
}

void AppendCell(std::string& text, Direction direction) {
  text += direction == Direction::kClockwise ? "cw" : "ccw";
}

template <typename Number>
void AppendCell(std::string& text, Number value) {
  char buffer[32];
  const std::to_chars_result end = std::to_chars(buffer, buffer + sizeof buffer, value);
  text.append(buffer, end.ptr);
}

}  // namespace

std::string CsvTextOf(const Record& record) {
  DemandWritable(record);
  std::string text = fmt::format("# kind: {}\n", record.kind.name());
  for (const auto& [key, value] : record.metadata) {
    text += value.empty() ? fmt::format("# {}:\n", key) : fmt::format("# {}: {}\n", key, value);
  }
  for (std::size_t c = 0; c < record.columns.size(); ++c) {
    if (c > 0) text += ',';
    text += record.columns[c].name;
  }
  text += '\n';
  text.reserve(text.size() + record.rows() * record.columns.size() * 20);
  for (std::size_t row = 0; row < record.rows(); ++row) {
    for (std::size_t c = 0; c < record.columns.size(); ++c) {
      if (c > 0) text += ',';
      std::visit([&](const auto& values) { AppendCell(text, values[row]); }, record.columns[c].values);
    }
    text += '\n';
  }
  return text;
}

void WriteCsvRecord(const Record& record, const std::filesystem::path& path) {
  WriteFileAtomically(path, CsvTextOf(record));
}

}  // namespace strainwave::daq
