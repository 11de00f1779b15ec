// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "analysis/quantities.h"
#include "bench/campaign/calibrations.h"
#include "bench/campaign/campaign.h"
#include "bench/campaign/cycle_context.h"
#include "bench/campaign/pictures.h"
#include "bench/campaign/recompute.h"
#include "bench/campaign/record_context.h"
#include "bench/commands/check_report.h"
#include "bench/commands/commands.h"
#include "bench/commands/map_option.h"
#include "bench/commands/output.h"
#include "bench/commands/record_report.h"
#include "bench/commands/results_table.h"
#include "bench/commands/tell_warnings.h"
#include "bench/commands/terminal.h"
#include "bench/errors/bench_error.h"
#include "bench/errors/output_path.h"
#include "bench/records/look_at_samples.h"
#include "bench/records/record_reader.h"
#include "bench/records/record_warnings.h"

namespace strainwave::bench {
namespace {

namespace quantities = analysis::quantities;
using analysis::StiffnessMethod;

StiffnessMethod MethodNamed(const std::string& name) {
  return *std::ranges::find(analysis::kStiffnessMethods, name,
                            [](StiffnessMethod method) { return NameOf(method); });
}

std::vector<std::string> MethodNames() {
  std::vector<std::string> names;
  for (const StiffnessMethod method : analysis::kStiffnessMethods) names.emplace_back(NameOf(method));
  return names;
}

struct RecomputeOptions {
  std::vector<std::string> paths;
  std::string method{"model"};
  std::string plots;
  std::string calibrations;
  std::string map;
  bool json{};
};

// What was computed again, beside the times of the journal.
std::vector<TimedResults> AgainAndWhen(const std::vector<RecomputedCycle>& cycles) {
  std::vector<TimedResults> timed;
  for (const RecomputedCycle& cycle : cycles) {
    if (cycle.cycle > 0) timed.push_back({cycle.ended_s / kDay_s, cycle.again.results});
  }
  return timed;
}

// Another method, or calibrations of later, are to give something else.
bool MustEqual(const RecomputeOptions& options) {
  return options.calibrations.empty() && MethodNamed(options.method) == CycleContext{}.method;
}

// Standard output is the document's alone where there is one.
void ListPictures(const std::vector<std::filesystem::path>& pictures, bool json) {
  for (const auto& picture : pictures) {
    const std::string line = fmt::format("picture: {}.svg (and .png)\n", picture.string());
    json ? ToStderr("{}", line) : ToStdout("{}", line);
  }
}

struct CampaignReport {
  nlohmann::json json;
  std::string checks;
  std::vector<std::filesystem::path> pictures;
};

CampaignReport RecomputeFolder(const CampaignFolder& folder, const RecomputeOptions& options) {
  const Journal journal = OpenCampaign(folder, Database::Mode::kReadOnly);
  const std::vector<std::string> warnings = WarningsAbout(folder, journal);
  for (const std::string& warning : warnings) ToStderr("{}\n", warning);
  const CampaignInputs inputs = ReadFrozenInputs(folder, journal);
  CycleContext context = ContextOf(journal, inputs.schedule, inputs.bench);
  context.method = MethodNamed(options.method);
  if (!options.calibrations.empty()) context.recalibrations = ReadCalibrations(options.calibrations);
  TerminalLine line;
  const auto cycles = RecomputeCampaign(folder, journal, context, [&](std::size_t done, std::size_t all) {
    line.Show(fmt::format("{} of {} cycles", done, all));
  });
  line.Clear();
  nlohmann::json rows = nlohmann::json::array();
  nlohmann::json differing = nlohmann::json::array();
  for (const RecomputedCycle& cycle : cycles) {
    if (!cycle.equal) differing.push_back(cycle.cycle);
    if (cycle.cycle == 0) continue;
    nlohmann::json row = CycleJson(cycle.cycle, cycle.again.results);
    row["equals_stored"] = cycle.equal;
    rows.push_back(std::move(row));
  }
  const auto checks = CheckHistories(inputs.schedule, AgainAndWhen(cycles));
  std::vector<std::filesystem::path> pictures;
  if (!options.plots.empty()) pictures = DrawCampaign(folder, journal, options.plots);
  return {{{"kind", "campaign"},
           {"folder", folder.root.string()},
           {"method", options.method},
           {"cycles_recomputed", cycles.size()},
           {"cycles_equal_to_stored", cycles.size() - differing.size()},
           {"cycles_differing", std::move(differing)},
           {"sensor_checks", CheckJson(checks)},
           {"warnings", warnings},
           {"cycles", std::move(rows)}},
          CheckText(checks),
          std::move(pictures)};
}

void PrintCampaignText(const CampaignReport& campaign) {
  const nlohmann::json& report = campaign.json;
  constexpr std::array kColumns{quantities::kEAvg, quantities::kEMax, quantities::kLostMotion,
                                quantities::kK1,   quantities::kK2,   quantities::kK3};
  // One digit more than the table of a campaign has, to compare by.
  const auto width = [](const analysis::Quantity& column) { return column.units().width + 1; };
  ToStdout("{}\n{:>6}", report["folder"].get<std::string>(), "cycle");
  for (const analysis::Quantity& column : kColumns) ToStdout(" {:>{}}", ColumnTitle(column), width(column));
  ToStdout("\n");
  for (const auto& row : report["cycles"]) {
    ToStdout("{:>6}", row["cycle"].get<int>());
    for (const analysis::Quantity& column : kColumns) {
      const auto value = row.find(column.name);
      const bool known = value != row.end() && value->is_number();
      ToStdout(" {}", ValueCell(known ? value->get<double>() : std::nan(""), width(column),
                                column.units().decimals + 1));
    }
    ToStdout("{}\n", row["equals_stored"].get<bool>() ? "" : "  differs from what is stored");
  }
  ToStdout("{} of {} cycles equal what was stored while the campaign ran, bit for bit\n",
           report["cycles_equal_to_stored"].get<std::size_t>(),
           report["cycles_recomputed"].get<std::size_t>());
  if (const auto& differing = report["cycles_differing"]; !differing.empty() && differing.front() == 0) {
    ToStdout("cycle 0, blank test and repeats, differs from what is stored\n");
  }
  if (!campaign.checks.empty()) ToStdout("sensor checks\n{}", campaign.checks);
}

int Recompute(const RecomputeOptions& options) {
  if (!options.plots.empty()) DemandOutputFolder(options.plots);
  nlohmann::json reports = nlohmann::json::array();
  bool differs = false;
  bool failed = false;
  const RecordReader reader(options.map);
  ShareLine line;
  double done = 0.0;
  for (const std::string& path : options.paths) {
    const double share = done++ / static_cast<double>(options.paths.size());
    if (std::filesystem::is_directory(path)) {
      CampaignReport campaign = RecomputeFolder({path}, options);
      if (!options.json) PrintCampaignText(campaign);
      ListPictures(campaign.pictures, options.json);
      differs = differs || !campaign.json["cycles_differing"].empty();
      reports.push_back(std::move(campaign.json));
      continue;
    }
    line.Show("reading " + FileText(path), share);
    const std::optional<CampaignBeside> beside = FindCampaignBeside(path);
    for (daq::Record& record : reader.Read(path)) {
      // A cycle's file holds records of other kinds beside those that have something to compute.
      const bool computable =
          record.kind == daq::RecordKind::kTransmissionError || record.kind == daq::RecordKind::kHysteresis;
      if (!computable && record.source.first_data_line == 0) continue;
      line.Show("computing from " + FileText(path), share);
      LookAtSamples(record);
      const RecordContext context = ContextOfRecord(record, beside);
      nlohmann::json report = RecordJson(record, MethodNamed(options.method), context);
      for (const std::string& warning : context.warnings) record.notes.push_back({0, warning});
      for (const auto& warning : report.value("warnings", nlohmann::json::array()))
        record.notes.push_back({0, warning.get<std::string>()});
      const std::vector<RecordWarning> warnings = WarningsOf(record);
      TellWarnings(warnings);
      report["warnings"] = WarningTexts(warnings);
      reports.push_back(std::move(report));
      failed = failed || !reports.back()["failed_checks"].empty();
      if (!options.json) ToStdout("{}", RecordText(reports.back(), record.source.file));
      if (options.plots.empty()) continue;
      ListPictures(DrawRecord(record, MethodNamed(options.method), context.corrections, options.plots),
                   options.json);
    }
  }
  line.Clear();
  if (reports.empty()) {
    throw BenchError(
        ExitCode::kWrongInput,
        fmt::format("{}: error: no record to recompute (expected transmission_error or hysteresis)",
                    options.paths.front()));
  }
  if (options.json) ToStdout("{}\n", (reports.size() == 1 ? reports.front() : reports).dump(2));
  const bool is_bad = failed || (differs && MustEqual(options));
  return static_cast<int>(is_bad ? ExitCode::kEndedBadly : ExitCode::kDone);
}

}  // namespace

void AddRecompute(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "recompute",
      "Transmission error and stiffness again from raw data: campaign folders, or record files (CSV, HDF5).\n"
      "Exit code 1 where a check of a record fails, or a campaign does not give what it has stored.\n"
      "Example: strainwave recompute campaigns/first --plots pictures");
  auto options = std::make_shared<RecomputeOptions>();
  command->add_option("PATH", options->paths, "campaign folders and record files")->required();
  command->add_option("--method", options->method, "of the stiffness: model, loading (secants) or backbone")
      ->capture_default_str()
      ->check(CLI::IsMember(MethodNames()));
  command->add_option("--plots", options->plots, "folder for pictures (SVG and PNG)");
  command->add_option("--calibrations", options->calibrations,
                      "file of later calibrations (YAML): a campaign's raw values are scaled anew with them");
  AddMapOption(*command, options->map);
  command->add_flag("--json", options->json, "JSON on standard output");
  command->callback([options, &action] { action = [options] { return Recompute(*options); }; });
}

}  // namespace strainwave::bench
