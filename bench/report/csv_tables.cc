// SPDX-License-Identifier: Apache-2.0
#include "bench/report/csv_tables.h"

#include <fmt/format.h>

#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

std::string CsvCell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string CsvRow(const std::vector<std::string>& cells) {
  std::string row;
  for (const std::string& cell : cells) row += (&cell == cells.data() ? "" : ",") + CsvCell(cell);
  return row + "\n";
}

}  // namespace

int WriteCsvTables(const ReportDocument& document, std::span<const CampaignSheet> sheets,
                   const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  int files = 0;
  for (const ReportSection& section : document.sections) {
    for (const ReportPart& part : section.parts) {
      const auto* const table = std::get_if<ReportTable>(&part);
      if (table == nullptr || table->name.empty()) continue;
      std::string csv = CsvRow(table->heads);
      for (const auto& row : table->rows) csv += CsvRow(row);
      daq::WriteFileAtomically(folder / (table->name + ".csv"), csv);
      ++files;
    }
  }
  for (std::size_t i = 0; i < sheets.size(); ++i) {
    const std::string number = sheets.size() > 1 ? fmt::format("{}_", i + 1) : "";
    daq::WriteFileAtomically(folder / (number + "cycles.csv"), sheets[i].cycles_csv);
    ++files;
  }
  return files;
}

}  // namespace strainwave::bench
