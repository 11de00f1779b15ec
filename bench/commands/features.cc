// SPDX-License-Identifier: Apache-2.0

#include <cmath>
#include <memory>

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "analysis/wavelets/packets.h"
#include "bench/commands/commands.h"
#include "bench/commands/map_option.h"
#include "bench/commands/output.h"
#include "bench/commands/tell_warnings.h"
#include "bench/commands/terminal.h"
#include "bench/errors/bench_error.h"
#include "bench/prediction/campaign_features.h"
#include "bench/prediction/measurement_paths.h"
#include "bench/prediction/record_features.h"
#include "bench/records/record_data.h"

namespace strainwave::bench {
namespace {

namespace features = analysis::features;
namespace wavelets = analysis::wavelets;

struct FeaturesCommand {
  std::vector<std::string> paths;
  std::string set{"wavelet"};
  std::string wavelet{"sym8"};
  int levels{7};
  std::string mode{"symmetric"};
  std::string channel;
  bool coefficients{};
  bool packet{};
  bool motor_torque{};
  std::string map;
  bool json{};
};

// A block a channel: the features downwards, the levels across.
void PrintWaveletTable(const RecordFeatures& values, const std::vector<std::string>& channels, int levels) {
  const auto columns = static_cast<std::size_t>(levels);
  auto value = values.values.begin();
  for (const std::string& channel : channels) {
    ToStdout("  {:<42}", channel);
    for (int level = 1; level <= levels; ++level) ToStdout(" {:>11}", fmt::format("a{}", level));
    ToStdout("\n");
    for (std::size_t row = 0; row < features::kSeriesFeatures; ++row) {
      ToStdout("    {:<40}", features::kSeriesFeatureNames[row]);
      for (std::size_t column = 0; column < columns; ++column) {
        ToStdout(" {:>11.5g}", value[static_cast<std::ptrdiff_t>(column * features::kSeriesFeatures + row)]);
      }
      ToStdout("\n");
    }
    value += static_cast<std::ptrdiff_t>(columns * features::kSeriesFeatures);
  }
}

nlohmann::ordered_json FeaturesReport(const daq::Record& record, const FeaturesCommand& command,
                                      ChannelFeatures& channel_features) {
  RecordFeatures values = FeaturesOfRecord(record, channel_features);
  if (!command.json) {
    ToStdout("{}{}{}\n", record.source.file, record.source.group.empty() ? "" : " ", record.source.group);
    if (channel_features.settings().set != FeatureSet::kWavelet) {
      for (std::size_t i = 0; i < values.names.size(); ++i) {
        ToStdout("  {:<50} {:>11.5g}\n", values.names[i], values.values[i]);
      }
    } else {
      PrintWaveletTable(values, VibrationChannelsOf(record), command.levels);
    }
  }
  return {{"names", std::move(values.names)}, {"values", std::move(values.values)}};
}

// Length, energy and share of the energy of one series of coefficients.
void PrintSeries(const std::string& name, const std::vector<double>& series, double signal_energy) {
  double energy = 0.0;
  for (const double value : series) energy += value * value;
  const double share = signal_energy > 0.0 ? 100.0 * energy / signal_energy : 0.0;
  ToStdout("  {:<18} {:>8} coefficients  energy {:>11.5g}  {:6.2f} % of the signal's\n", name, series.size(),
           energy, share);
}

nlohmann::ordered_json CoefficientsReport(const daq::Record& record, const FeaturesCommand& command) {
  const std::vector<double> signal = ChannelOf(record, command.channel);
  const wavelets::FilterBank bank = wavelets::FilterBankOf(command.wavelet);
  const wavelets::Border border = wavelets::BorderOf(command.mode);
  double energy = 0.0;
  for (const double value : signal) energy += value * value;
  if (!command.json) ToStdout("{}\n", record.source.file);
  if (command.packet) {
    wavelets::Packets packets;
    wavelets::DecomposePackets(signal, bank, border, command.levels, packets);
    std::vector<std::string> paths = wavelets::PacketPaths(command.levels);
    for (std::size_t leaf = 0; leaf < paths.size() && !command.json; ++leaf) {
      PrintSeries(paths[leaf], packets.leaves[leaf], energy);
    }
    return {{"paths", std::move(paths)}, {"leaves", std::move(packets.leaves)}};
  }
  wavelets::Decomposition decomposition;
  wavelets::Decompose(signal, bank, border, command.levels, wavelets::Details::kKeep, decomposition);
  if (!command.json) {
    PrintSeries(fmt::format("approximation {}", command.levels), decomposition.approximations.back(), energy);
    for (std::size_t level = decomposition.details.size(); level > 0; --level) {
      PrintSeries(fmt::format("detail {}", level), decomposition.details[level - 1], energy);
    }
  }
  return {{"approximation", std::move(decomposition.approximations.back())},
          {"details", std::move(decomposition.details)}};
}

// Those of a campaign stay in its folder; people are told where.
nlohmann::ordered_json JsonOfCampaign(const std::filesystem::path& folder, const FeaturesCommand& command,
                                      const FeatureSettings& settings, ShareLine& line) {
  const CampaignFeatures all =
      FeaturesOfCampaign(folder, settings, command.motor_torque, [&line](std::size_t done, std::size_t of) {
        line.Show("features", static_cast<double>(done) / static_cast<double>(of));
      });
  line.Clear();
  std::vector<RecordWarning> warnings;
  if (!all.not_kept.empty())
    warnings.push_back(
        {folder.string(), 0, "the features are not kept and are computed anew each time: " + all.not_kept});
  TellWarnings(warnings);
  if (!command.json) {
    ToStdout("{}: {} features of {} cycles{}\n", folder.string(), all.names.size(), all.cycle.size(),
             warnings.empty() ? ", in " + FeaturesFile(folder, settings.set).string() : "");
    for (const std::string& note : all.notes) ToStdout("note: {}\n", note);
    return {};
  }
  nlohmann::ordered_json cycles = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < all.cycle.size(); ++i) {
    const auto row = all.values.row(static_cast<Eigen::Index>(i));
    cycles.push_back({{"cycle", all.cycle[i]}, {"values", std::vector<double>(row.begin(), row.end())}});
  }
  nlohmann::ordered_json report{{"campaign", folder.string()},
                                {"names", all.names},
                                {"cycles", std::move(cycles)},
                                {"notes", all.notes}};
  if (!warnings.empty()) report["warnings"] = WarningTexts(warnings);
  return report;
}

int Run(const FeaturesCommand& command) {
  const FeatureSettings settings{.set = FeatureSetOf(command.set),
                                 .wavelet = {.wavelet = command.wavelet,
                                             .border = wavelets::BorderOf(command.mode),
                                             .levels = command.levels},
                                 .orders = {}};
  ChannelFeatures channel_features(settings);
  nlohmann::ordered_json reports = nlohmann::ordered_json::array();
  ShareLine line;
  const MeasurementPaths paths = SortPaths({command.paths.begin(), command.paths.end()});
  if (command.coefficients && !paths.campaigns.empty()) {
    Refuse(paths.campaigns.front(), "is a campaign", "records for --coefficients");
  }
  for (const std::filesystem::path& folder : paths.campaigns) {
    nlohmann::ordered_json report = JsonOfCampaign(folder, command, settings, line);
    if (command.json) reports.push_back(std::move(report));
  }
  const RecordReader reader(command.map);
  std::size_t done = 0;
  for (const std::filesystem::path& path : paths.files) {
    const double share = static_cast<double>(done++) / static_cast<double>(paths.files.size());
    line.Show("reading " + FileText(path), share);
    for (const daq::Record& record :
         ReadVibrationRecords(path, MotorTorqueAdded(command.motor_torque), reader)) {
      const std::vector<RecordWarning> warnings = WarningsOf(record);
      TellWarnings(warnings);
      line.Show("features of " + FileText(path), share);
      nlohmann::ordered_json report = command.coefficients
                                          ? CoefficientsReport(record, command)
                                          : FeaturesReport(record, command, channel_features);
      if (!warnings.empty()) report["warnings"] = WarningTexts(warnings);
      if (command.json) reports.push_back(std::move(report));
    }
  }
  line.Clear();
  if (command.json) ToStdout("{}\n", (reports.size() == 1 ? reports.front() : reports).dump());
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void AddFeatures(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "features",
      "Features of vibration records: 35 values of the wavelet approximations of every level and channel, "
      "named\n"
      "CHANNEL.aLEVEL.COLUMN; or energies in bands of orders; or the coefficients themselves.\n"
      "Example: strainwave features vibration.csv --json\n"
      "         strainwave features campaigns/first\n"
      "         strainwave features vibration.csv --coefficients --wavelet db6 --levels 3 --channel "
      "accel_x_m_per_s2");
  auto options = std::make_shared<FeaturesCommand>();
  command
      ->add_option(
          "PATH", options->paths,
          "record files of kind vibration (CSV, HDF5), folders of these, campaigns (whose features are "
          "kept in their folder)")
      ->required();
  command->add_flag("--motor-torque", options->motor_torque,
                    "the motor's torque (from its current), logged beside the vibration, as a channel");
  command->add_option("--set", options->set, "wavelet, or orders (energies by order of the input shaft)")
      ->capture_default_str()
      ->check(CLI::IsMember({"wavelet", "orders"}));
  command->add_option("--wavelet", options->wavelet, "haar, db1 to db20, sym2 to sym20, coif1 to coif5")
      ->capture_default_str();
  command->add_option("--levels", options->levels, "of the decomposition")
      ->capture_default_str()
      ->check(CLI::Range(1, wavelets::kMostLevels));
  command->add_option("--mode", options->mode, "border: symmetric, periodization or zero")
      ->capture_default_str()
      ->check(CLI::IsMember({"symmetric", "periodization", "zero"}));
  CLI::Option* coefficients = command->add_flag("--coefficients", options->coefficients,
                                                "wavelet coefficients of one channel in place of features");
  command->add_option("--channel", options->channel, "the channel, where there are several")
      ->needs(coefficients);
  command->add_flag("--packet", options->packet, "leaves of the wavelet packet, in natural order")
      ->needs(coefficients);
  AddMapOption(*command, options->map);
  command->add_flag("--json", options->json, "JSON on standard output; null where a feature has no value");
  command->callback([options, &action] { action = [options] { return Run(*options); }; });
}

}  // namespace strainwave::bench
