// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/commands/commands.h"
#include "bench/commands/output.h"
#include "bench/errors/bench_error.h"
#include "bench/life/times_picture.h"
#include "bench/life/times_report.h"
#include "bench/plots/gnuplot.h"

namespace strainwave::bench {
namespace {

struct LifeOptions {
  std::vector<std::string> paths;
  double level_percent{90.0};
  std::vector<double> percents{10.0, 50.0};
  std::vector<double> at;
  double shape{};
  int parameters{2};
  std::string bounds{"lr"};
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

int LifeOfTimes(const LifeOptions& options) {
  const TimesReport report = ReportOf(ReadTimes(options.paths.front()), SettingsOf(options));
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

int TellLife(const LifeOptions& options) {
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
                                         "and where known unit, since_h, count, mode.\n"
                                         "Example: strainwave life times.csv --plots pictures");
  auto options = std::make_shared<LifeOptions>();
  command->add_option("PATH", options->paths, "a table of times (CSV)")->required();
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
  command->add_option("--plots", options->plots, "folder for the picture");
  command->add_flag("--json", options->json, "one JSON document on standard output");
  command->callback([options, &action] { action = [options] { return TellLife(*options); }; });
}

}  // namespace strainwave::bench
