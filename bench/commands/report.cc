// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/campaign/disk_room.h"
#include "bench/commands/commands.h"
#include "bench/commands/output.h"
#include "bench/errors/bench_error.h"
#include "bench/report/csv_tables.h"
#include "bench/report/document.h"
#include "bench/report/html.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

constexpr double kForecastLevel = 0.95;

struct ReportOptions {
  std::vector<std::string> folders;
  std::string out;
  std::string csv;
  bool json{};
};

int WriteReport(const ReportOptions& options) {
  std::vector<std::string> warnings;
  std::vector<CampaignSheet> sheets;
  for (const std::string& folder : options.folders)
    sheets.push_back(ReadCampaignSheet(folder, kForecastLevel, warnings));
  const ReportDocument document = ReportDocumentOf(sheets, warnings);
  for (const std::string& warning : warnings) ToStderr("{}\n", warning);
  const std::string html = HtmlOf(document);
  daq::WriteFileAtomically(options.out, html);
  const int files = options.csv.empty() ? 0 : WriteCsvTables(document, sheets, options.csv);
  if (options.json) {
    ToStdout("{}\n", nlohmann::ordered_json{{"folders", options.folders},
                                            {"out", options.out},
                                            {"bytes", html.size()},
                                            {"csv_files", files},
                                            {"warnings", warnings}}
                         .dump(2));
    return static_cast<int>(ExitCode::kDone);
  }
  ToStdout("{}: {} campaign{}, {} sections, {}\n", options.out, sheets.size(), sheets.size() == 1 ? "" : "s",
           document.sections.size(), BytesText(static_cast<double>(html.size())));
  if (files > 0) ToStdout("{}: {} tables as CSV\n", options.csv, files);
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void AddReport(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("report",
                         "One page of a campaign, or of several beside each other, to keep and to print: "
                         "what was tested, how it went, "
                         "what has changed with 95 % intervals, when stop criteria will be met, and whether "
                         "all of it is still what was "
                         "written. It loads nothing from elsewhere.\n"
                         "Example: strainwave report campaigns/first --out first.html --csv first_tables");
  auto options = std::make_shared<ReportOptions>();
  command->add_option("DIR", options->folders, "folders of campaigns")->required();
  command->add_option("--out", options->out, "HTML file to write; one of that name is replaced")->required();
  command->add_option("--csv", options->csv,
                      "folder for the same numbers as CSV; files of the same names are replaced");
  command->add_flag("--json", options->json, "what was written, as JSON on standard output");
  command->callback([options, &action] { action = [options] { return WriteReport(*options); }; });
}

}  // namespace strainwave::bench
