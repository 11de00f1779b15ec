// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/campaign/campaign_status.h"
#include "bench/campaign/cycle_table.h"
#include "bench/commands/commands.h"
#include "bench/commands/output.h"
#include "bench/errors/bench_error.h"
#include "bench/errors/output_path.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

struct TableOptions {
  std::string folder;
  std::string out;
  bool json{};
};

int WriteTable(const TableOptions& options) {
  DemandOutputFile(options.out);
  const CampaignFolder folder{options.folder};
  const Journal journal = OpenCampaign(folder, Database::Mode::kReadOnly);
  const std::vector<std::string> warnings = WarningsAbout(folder, journal);
  for (const std::string& warning : warnings) ToStderr("{}\n", warning);
  const CycleTable table = CycleTableOf(journal);
  if (table.rows == 0)
    Refuse(folder.root, "has no complete cycle yet", "one at least; strainwave status shows how far it is");
  daq::WriteFileAtomically(options.out, table.csv);
  if (options.json) {
    ToStdout("{}\n", nlohmann::ordered_json{{"folder", options.folder},
                                            {"out", options.out},
                                            {"rows", table.rows},
                                            {"columns", table.columns},
                                            {"warnings", warnings}}
                         .dump(2));
  } else {
    ToStdout("{}: {} cycles, {} columns\n", options.out, table.rows, table.columns);
  }
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void AddTable(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "table",
      "One row a cycle, all results with their standard errors, for a spreadsheet, R, Python.\n"
      "Example: strainwave table campaigns/first --out first.csv");
  auto options = std::make_shared<TableOptions>();
  command->add_option("CAMPAIGN", options->folder, "folder of the campaign")->required();
  command->add_option("--out", options->out, "CSV file to write; one of that name is replaced")->required();
  command->add_flag("--json", options->json, "what was written, as JSON on standard output");
  command->callback([options, &action] { action = [options] { return WriteTable(*options); }; });
}

}  // namespace strainwave::bench
