// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/commands/commands.h"
#include "bench/commands/map_option.h"
#include "bench/commands/output.h"
#include "bench/commands/tell_warnings.h"
#include "bench/errors/bench_error.h"
#include "bench/errors/output_path.h"
#include "bench/records/record_reader.h"
#include "bench/records/record_warnings.h"
#include "bench/records/write_record.h"

namespace strainwave::bench {
namespace {

struct ConvertOptions {
  std::string in;
  std::string out;
  std::string map;
  std::string group;
  bool preview{};
  bool json{};
};

int Preview(const ConvertOptions& options) {
  const std::vector<std::string> lines = PreviewOfFile(options.in);
  if (options.json) {
    ToStdout("{}\n", nlohmann::ordered_json{{"file", options.in}, {"preview", lines}}.dump(2));
  } else {
    ToStdout("{}\n", options.in);
    for (const std::string& line : lines) ToStdout("  {}\n", line);
  }
  return static_cast<int>(ExitCode::kDone);
}

int Convert(const ConvertOptions& options) {
  if (options.preview) return Preview(options);
  if (options.out.empty()) Refuse("convert", "--out is not given", "a file to write, or --preview");
  DemandFolderOf(options.out);
  std::vector<daq::Record> records = RecordReader(options.map).Read(options.in);
  std::erase_if(records, [&](const daq::Record& record) {
    return record.source.group.find(options.group) == std::string::npos;
  });
  if (records.empty())
    Refuse(options.in, fmt::format("has no group with '{}' in its name", options.group), "a part of one");
  WriteRecords(records, options.out);
  std::vector<std::string> warnings;
  for (const daq::Record& record : records) {
    TellWarnings(WarningsOf(record));
    for (std::string& text : WarningTexts(WarningsOf(record))) warnings.push_back(std::move(text));
  }
  nlohmann::ordered_json written = nlohmann::ordered_json::array();
  for (const daq::Record& record : records) {
    nlohmann::ordered_json columns = nlohmann::ordered_json::array();
    for (const daq::Column& column : record.columns) columns.push_back(column.name);
    written.push_back({{"kind", record.kind.name()}, {"rows", record.rows()}, {"columns", columns}});
    if (!options.json)
      ToStdout("{}: {}, {} rows of {} columns\n", options.out, record.kind.name(), record.rows(),
               record.columns.size());
  }
  if (options.json)
    ToStdout("{}\n",
             nlohmann::ordered_json{
                 {"in", options.in}, {"out", options.out}, {"records", written}, {"warnings", warnings}}
                 .dump(2));
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void AddMapOption(CLI::App& command, std::string& map) {
  command.add_option(
      "--map", map,
      "mapping file (YAML) of files that others wrote; strainwave convert FILE --preview shows "
      "what is in one");
}

void AddConvert(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "convert",
      "Read what instruments and other programs write, and write records, or the other way round: CSV in "
      "its\n"
      "dialects, MAT 5 and 7.3, UFF 58, TDMS, WAV, FLAC, HDF5 to CSV, HDF5, MAT 5, UFF 58.\n"
      "Example: strainwave convert loop.mat --preview\n"
      "         strainwave convert loop.mat --map loop.yaml --out loop.csv");
  auto options = std::make_shared<ConvertOptions>();
  command->add_option("IN", options->in, "the file to read")->required();
  command->add_option("--out", options->out,
                      "the file to write, by its ending: .csv, .h5, .mat, .uff (.unv)");
  AddMapOption(*command, options->map);
  command->add_option("--group", options->group, "of an HDF5 file: part of the name of the record's group");
  command->add_flag("--preview", options->preview,
                    "show format, channels, units, rates, first values; write nothing");
  command->add_flag("--json", options->json, "what was written, as JSON on standard output");
  command->callback([options, &action] { action = [options] { return Convert(*options); }; });
}

}  // namespace strainwave::bench
