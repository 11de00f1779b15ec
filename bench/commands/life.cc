// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/commands/commands.h"
#include "bench/commands/output.h"
#include "bench/commands/server_option.h"
#include "bench/errors/bench_error.h"
#include "bench/errors/output_path.h"
#include "bench/life/accelerated_report.h"
#include "bench/life/campaign_lives.h"
#include "bench/life/times_picture.h"
#include "bench/life/times_report.h"
#include "bench/plots/gnuplot.h"
#include "daq/record.h"

namespace strainwave::bench {
namespace {

struct LifeOptions {
  std::vector<std::string> paths;
  FromServer from;
  double level_percent{90.0};
  std::vector<double> percents{10.0, 50.0};
  std::vector<double> at;
  double shape{};
  int parameters{2};
  std::string bounds{"lr"};
  double use_torque_Nm{};
  double use_speed_rpm{};
  std::string exponents{"prior"};
  std::vector<std::string> limits;
  bool join{};
  std::string plots;
  bool json{};
};

LifeBounds BoundsOfName(const std::string& name) {
  if (name == "lr") return LifeBounds::kCorrected;
  if (name == "lr-plain") return LifeBounds::kLikelihoodRatio;
  if (name == "fisher") return LifeBounds::kFisher;
  Refuse("--bounds", fmt::format("'{}' are no bounds", name), "lr, lr-plain or fisher");
}

LifeSettings SettingsOf(const LifeOptions& options) {
  LifeSettings settings;
  settings.level = options.level_percent / 100.0;
  settings.shares.clear();
  for (const double percent : options.percents) settings.shares.push_back(percent / 100.0);
  settings.at = options.at;
  if (options.shape > 0.0) settings.shape = options.shape;
  settings.three_parameters = options.parameters == 3;
  settings.bounds = BoundsOfName(options.bounds);
  return settings;
}

UseLoad UseOf(const LifeOptions& options) {
  UseLoad use;
  if (options.use_torque_Nm > 0.0) use.torque_Nm = options.use_torque_Nm;
  if (options.use_speed_rpm > 0.0) use.speed_rpm = options.use_speed_rpm;
  if (options.exponents == "catalogue") {
    use.exponents = Exponents::kCatalogue;
  } else if (options.exponents == "fitted") {
    use.exponents = Exponents::kFitted;
  } else if (options.exponents != "prior") {
    Refuse("--exponents", fmt::format("'{}' says not where they come from", options.exponents),
           "prior, catalogue or fitted");
  }
  return use;
}

int LifeAtUse(const TimesTable& table, const LifeOptions& options, const UseLoad& use) {
  const AcceleratedReport report = AcceleratedReportOf(table, SettingsOf(options), use);
  for (const std::string& warning : report.warnings) ToStderr("warning: {}\n", warning);
  options.json ? ToStdout("{}\n", JsonOf(report).dump(2)) : ToStdout("{}", TextOf(report));
  return static_cast<int>(ExitCode::kDone);
}

int LifeOfTimes(const LifeOptions& options) {
  const TimesTable table = ReadTimes(options.paths.front());
  const UseLoad use = UseOf(options);
  if (use.torque_Nm || use.speed_rpm) return LifeAtUse(table, options, use);
  if (table.has_torque || table.has_speed)
    ToStderr("warning: loads count with --use-torque or --use-speed alone: times are taken as they are\n");
  const TimesReport report = ReportOf(table, SettingsOf(options));
  for (const std::string& warning : report.warnings) ToStderr("warning: {}\n", warning);
  options.json ? ToStdout("{}\n", JsonOf(report).dump(2)) : ToStdout("{}", TextOf(report));
  if (options.plots.empty()) return static_cast<int>(ExitCode::kDone);
  try {
    const auto picture = DrawTimes(report, std::filesystem::path(options.plots) / "weibull");
    if (picture && !options.json) ToStdout("picture: {}.svg (and .png)\n", picture->string());
    if (!picture) ToStderr("no picture: it shows a law of two parameters, fitted to one mode\n");
  } catch (const GnuplotError& error) {
    ToStderr("error: no picture: {}\n", error.what());
    return static_cast<int>(ExitCode::kMachineFailed);
  }
  return static_cast<int>(ExitCode::kDone);
}

LimitShares SharesOf(const LifeOptions& options) {
  LimitShares shares;
  for (const std::string& text : options.limits) {
    const std::size_t equals = text.find('=');
    const auto percent =
        equals == std::string::npos ? std::nullopt : daq::NumberFromText(text.substr(equals + 1));
    if (!percent || !std::isfinite(*percent) || !(*percent > 0.0) || *percent == 100.0)
      Refuse("--limit", fmt::format("'{}' is no limit", text),
             "QUANTITY=PERCENT of its first value, such as k2_Nm_per_rad=80");
    const std::string quantity = text.substr(0, equals);
    if (!shares.emplace(quantity, *percent / 100.0).second)
      Refuse("--limit", fmt::format("{} has two limits", quantity), "one of each quantity");
  }
  return shares;
}

// @param told  what was said already, and belongs to the report.
int LifeOfCampaigns(const LifeOptions& options, const std::vector<std::string>& folders,
                    const std::vector<std::string>& told) {
  CampaignsReport report = LivesOfCampaigns(folders, SettingsOf(options), SharesOf(options), options.join);
  for (const std::string& warning : report.warnings) ToStderr("warning: {}\n", warning);
  report.warnings.insert(report.warnings.begin(), told.begin(), told.end());
  options.json ? ToStdout("{}\n", JsonOf(report).dump(2)) : ToStdout("{}", TextOf(report));
  const bool has_limit =
      std::ranges::any_of(report.campaigns, [](const auto& one) { return !one.limits.empty(); });
  if (options.plots.empty() || !has_limit) return static_cast<int>(ExitCode::kDone);
  try {
    const auto picture = DrawForecasts(report, std::filesystem::path(options.plots) / "forecast");
    if (!options.json) ToStdout("picture: {}.svg (and .png)\n", picture.string());
  } catch (const GnuplotError& error) {
    ToStderr("error: no picture: {}\n", error.what());
    return static_cast<int>(ExitCode::kMachineFailed);
  }
  return static_cast<int>(ExitCode::kDone);
}

int TellLife(const LifeOptions& options) {
  if (!options.plots.empty()) DemandOutputFolder(options.plots);
  const CampaignFolders given(options.paths, options.from);
  if (!options.from.conninfo.empty()) return LifeOfCampaigns(options, given.paths(), given.warnings());
  const auto is_folder = [](const std::string& path) { return std::filesystem::is_directory(path); };
  if (std::ranges::all_of(options.paths, is_folder)) return LifeOfCampaigns(options, options.paths, {});
  if (std::ranges::any_of(options.paths, is_folder))
    Refuse(options.paths.front(), "is beside another kind of path", "campaigns, or one table of times");
  if (options.paths.size() > 1) Refuse(options.paths[1], "is a second table of times", "one, with all units");
  return LifeOfTimes(options);
}

}  // namespace

void AddLife(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("life",
                                         "How long units last, and how sure that is: a Weibull law of times "
                                         "to failure and suspension, with bounds.\n"
                                         "TIMES.csv has the columns time_h (or another unit: time_cycles), "
                                         "status (failed, suspended, before, between)\n"
                                         "and where known unit, since_h, count, mode, torque_Nm, speed_rpm.\n"
                                         "Of campaigns: the cycle at which each stop criterion will be met, "
                                         "the life of others like them, and which trends "
                                         "predict.\n"
                                         "Example: strainwave life times.csv --plots pictures");
  auto options = std::make_shared<LifeOptions>();
  CLI::Option* const paths =
      command->add_option("PATH", options->paths, "a table of times (CSV), or folders of campaigns");
  AddFromServer(*command, options->from, paths);
  command->add_option("--level", options->level_percent, "% of the two-sided intervals")
      ->check(CLI::Range(50.0, 99.9))
      ->capture_default_str();
  command->add_option("--failed", options->percents, "% that have failed: 10 for B10")
      ->check(CLI::Range(1e-6, 99.9999))
      ->capture_default_str();
  command->add_option("--at", options->at, "times to tell the survival of")->check(CLI::PositiveNumber);
  command
      ->add_option("--shape", options->shape,
                   "shape that is known from elsewhere: Weibayes, for none or one failure")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--parameters", options->parameters, "of the law; 3 with a time that every unit reaches")
      ->check(CLI::IsMember({2, 3}))
      ->capture_default_str();
  command
      ->add_option("--bounds", options->bounds,
                   "lr (likelihood ratio, corrected for few failures), lr-plain, or fisher; --json has all")
      ->capture_default_str();
  command
      ->add_option("--use-torque", options->use_torque_Nm,
                   "Nm at which the life is told; units may have run at others (column torque_Nm), in steps "
                   "(status ran)")
      ->check(CLI::PositiveNumber);
  command->add_option("--use-speed", options->use_speed_rpm, "rpm of the input likewise (column speed_rpm)")
      ->check(CLI::PositiveNumber);
  command
      ->add_option(
          "--exponents", options->exponents,
          "of torque and speed: prior (the catalogue's 3 ± 1 and 1 ± 0.5), catalogue (3 and 1), or fitted")
      ->capture_default_str();
  command->add_option(
      "--limit", options->limits,
      "of campaigns: QUANTITY=PERCENT of its first value, such as k3_Nm_per_rad=80, beside the "
      "schedule's stop criteria");
  command->add_flag("--join", options->join, "campaigns of different schedules, too");
  command->add_option("--plots", options->plots, "folder for the picture");
  command->add_flag("--json", options->json, "one JSON document on standard output");
  command->callback([options, &action] { action = [options] { return TellLife(*options); }; });
}

}  // namespace strainwave::bench
