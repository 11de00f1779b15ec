// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/central/campaign_query.h"
#include "bench/central/fetched_campaign.h"
#include "bench/central/schema.h"
#include "bench/commands/central_commands.h"
#include "bench/commands/no_core.h"
#include "bench/commands/output.h"
#include "bench/commands/server_option.h"
#include "bench/escaped.h"

namespace strainwave::bench {
namespace {

struct CampaignsOptions {
  std::string conninfo;
  std::string query;
  std::string out;
  std::string store;
  bool json{};
};

int ListCampaigns(const CampaignsOptions& options) {
  LeaveNoCore();
  CheckConninfo(options.conninfo);
  const CampaignQuery query = ParseCampaignQuery(options.query);
  Server server(options.conninfo);
  DemandSchema(server);
  const std::vector<FoundCampaign> found = FindCampaigns(server, query);
  nlohmann::ordered_json listed = nlohmann::ordered_json::array();
  if (!options.json)
    ToStdout("{:<28} {:<16} {:<16} {:<20} {:>6}\n", "campaign", "specimen", "schedule", "begun", "cycles");
  for (const FoundCampaign& one : found) {
    listed.push_back(
        {{"campaign", one.identity},
         {"bench", one.bench},
         {"specimen", one.specimen},
         {"schedule", one.schedule},
         {"started_utc", one.started_utc},
         {"complete", one.complete},
         {"caught_up", one.caught_up},
         {"same_as", one.same_as.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(one.same_as)}});
    if (options.json) continue;
    ToStdout("{:<28} {:<16} {:<16} {:<20.19} {:>6}{}{}\n", one.Name(), Escaped(one.specimen),
             Escaped(one.schedule), Escaped(one.started_utc), one.complete,
             one.caught_up ? "" : "  being forwarded",
             one.same_as.empty() ? "" : fmt::format("  {} again: life and report leave it out", one.same_as));
  }
  if (options.json) ToStdout("{}\n", listed.dump(2));
  return static_cast<int>(ExitCode::kDone);
}

int Fetch(const CampaignsOptions& options) {
  LeaveNoCore();
  std::vector<std::string> warnings;
  const std::vector<FetchedCampaign> all = FetchFromServer({options.conninfo, options.query, options.store},
                                                           options.out, Copies::kFetched, warnings);
  int records = 0;
  int missing = 0;
  nlohmann::ordered_json fetched = nlohmann::ordered_json::array();
  for (const FetchedCampaign& one : all) {
    records += one.records;
    missing += one.missing;
    fetched.push_back({{"folder", one.folder.string()},
                       {"complete", one.cycles},
                       {"records", one.records},
                       {"missing", one.missing},
                       {"warnings", one.warnings}});
    if (!options.json) ToStdout("{}: {} cycles, {} files\n", one.folder.string(), one.cycles, one.records);
  }
  if (options.json) ToStdout("{}\n", fetched.dump(2));
  if (missing == 0) return static_cast<int>(ExitCode::kDone);
  ToStderr("{}: error: {} of {} raw records are missing (expected all; the folders are whole but for them)\n",
           options.store, missing, records + missing);
  return static_cast<int>(ExitCode::kEndedBadly);
}

}  // namespace

void AddCentralCampaigns(CLI::App& central, Action& action) {
  const auto options = std::make_shared<CampaignsOptions>();
  CLI::App* list = central.add_subcommand(
      "list",
      "Which campaigns the server has.\n"
      "Example: strainwave central list --server service=lab --query 'bench=hall-* schedule=paper'");
  AddServerOption(*list, options->conninfo);
  AddQueryOption(*list, options->query);
  list->add_flag("--json", options->json, "one JSON document on standard output");
  list->callback([options, &action] { action = [options] { return ListCampaigns(*options); }; });

  CLI::App* fetch = central.add_subcommand(
      "fetch",
      "Folders of campaigns from what the server has of them, for every command that reads one: the same "
      "journal, row "
      "by row, and the same inputs; raw records with --store alone, and exit code 1 where that lacks some.\n"
      "Example: strainwave central fetch --server service=lab --query specimen=A1 --out fetched");
  AddServerOption(*fetch, options->conninfo);
  AddQueryOption(*fetch, options->query);
  fetch->add_option("--out", options->out, "folder for them, one below it for each")->required();
  fetch->add_option("--store", options->store, "folder of raw records that forward --store has filled");
  fetch->add_flag("--json", options->json, "one JSON document on standard output");
  fetch->callback([options, &action] { action = [options] { return Fetch(*options); }; });
}

}  // namespace strainwave::bench
