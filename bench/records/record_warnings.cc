// SPDX-License-Identifier: Apache-2.0
#include "bench/records/record_warnings.h"

#include <fmt/format.h>

#include "bench/records/metadata_warnings.h"

namespace strainwave::bench {

std::vector<RecordWarning> WarningsOf(const daq::Record& record) {
  const std::string& group = record.source.group;
  std::vector<RecordWarning> warnings;
  const auto add = [&](int line, const std::string& text) {
    warnings.push_back(
        {record.source.file, line, group.empty() ? text : fmt::format("group '{}': {}", group, text)});
  };
  for (const daq::RecordNote& note : record.notes) add(note.line, note.text);
  for (const std::string& warning : MetadataWarnings(record)) add(0, warning);
  return warnings;
}

std::string WarningLine(const RecordWarning& warning) {
  const std::string line = warning.line > 0 ? fmt::format(":{}", warning.line) : "";
  return fmt::format("{}{}{}warning: {}", warning.file, line, warning.file.empty() ? "" : ": ", warning.text);
}

std::vector<std::string> WarningTexts(std::span<const RecordWarning> warnings, NamedFiles files) {
  std::vector<std::string> texts;
  for (const RecordWarning& warning : warnings) {
    texts.push_back(files == NamedFiles::kYes && !warning.file.empty()
                        ? fmt::format("{}: {}", warning.file, warning.text)
                        : warning.text);
  }
  return texts;
}

}  // namespace strainwave::bench
