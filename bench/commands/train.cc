// SPDX-License-Identifier: Apache-2.0

#include <memory>
#include <mutex>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "bench/campaign/campaign_error.h"
#include "bench/commands/commands.h"
#include "bench/commands/terminal.h"
#include "bench/plots/gnuplot.h"
#include "bench/prediction/prediction_picture.h"
#include "bench/prediction/train_predictor.h"

namespace strainwave::bench {
namespace {

namespace prediction = analysis::prediction;

struct TrainCommand {
  std::vector<std::string> folders;
  std::string out;
  std::vector<std::string> outputs;
  std::string wavelet{"sym8"};
  int levels{7};
  TrainingJob job;
  bool json{};
};

void PrintSplit(const SplitResult& split, const std::vector<std::string>& outputs) {
  fmt::print("\n{} ({}): trained on {}, tested on {} records\n", split.name, split.meaning, split.train,
             split.test);
  fmt::print("  {:<20}", "MAPE, %");
  for (const std::string& output : outputs) fmt::print(" {:>15}", output);
  fmt::print(" {:>8}\n", "mean");
  for (const prediction::Contestant& contestant : split.contestants) {
    fmt::print("  {:<20}", contestant.name);
    for (const prediction::OutputScore& score : contestant.scores)
      fmt::print(" {:>15.3f}", score.mape_percent);
    fmt::print(" {:>8.3f}\n", prediction::MeanMape_percent(contestant.scores));
  }
}

void PrintReport(const TrainingData& data, const TrainingOutcome& outcome) {
  const FilterSummary& filter = outcome.filter;
  fmt::print("{} records of {} campaign{}; {} of {} vibration features kept (|r| filter on {} records)",
             data.samples.size(), data.sources.size(), data.sources.size() == 1 ? "" : "s",
             filter.vibration_kept, filter.vibration_features, filter.records);
  if (filter.torque_features > 0) {
    fmt::print("; {} of {} torque features say nothing new, and none is used",
               filter.torque_features - filter.torque_kept, filter.torque_features);
  }
  fmt::print("\n");
  for (const SplitResult& split : outcome.splits) PrintSplit(split, data.samples.outputs);
  const prediction::FittedPredictor& fitted = outcome.predictor.fitted;
  fmt::print("\n{:.0f} % intervals, in root mean square errors of records that no network had seen:\n",
             100.0 * fitted.band.coverage);
  for (std::size_t i = 0; i < data.samples.outputs.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    fmt::print("  {:<20} ±{:.2f} × {:.4g}\n", data.samples.outputs[i], fitted.band.factor(column),
               fitted.residual(column));
  }
  if (!fitted.band.guaranteed) {
    fmt::print("  too few reducers for a guarantee: these are the widest errors that were seen\n");
  }
  fmt::print("\nwhat the inputs are worth (rise of the mean MAPE when they are shuffled):\n");
  for (const prediction::Importance& importance : outcome.importances) {
    fmt::print("  {:<40} {:+.3f} ± {:.3f} %\n", importance.name, importance.mape_rise_percent,
               importance.standard_error_percent);
  }
  for (const std::string& note : data.notes) fmt::print("note: {}\n", note);
}

int Run(const TrainCommand& command) {
  ShareLine line;
  // Reading is a tenth of the work where nothing is kept from before.
  constexpr double kShareOfReading = 0.1;
  const analysis::features::WaveletRecipe recipe{.wavelet = command.wavelet, .levels = command.levels};
  const TrainingData data = ReadTrainingData(
      {command.folders.begin(), command.folders.end()}, recipe, command.outputs,
      [&](const std::string& step, double share) { line.Show(step, kShareOfReading * share); });
  std::mutex telling;
  const TrainingOutcome outcome =
      TrainPredictor(data, recipe, command.job, [&](const std::string& step, double share) {
        const std::lock_guard lock(telling);
        line.Show(step, kShareOfReading + (1.0 - kShareOfReading) * share);
        return true;
      });
  WritePredictor(command.out, outcome.predictor);
  std::string picture_trouble;
  const std::filesystem::path picture = std::filesystem::path(command.out) / "predicted";
  try {
    DrawPredictions(outcome.held_out, outcome.predictor.outputs, picture);
  } catch (const GnuplotError& error) {
    picture_trouble = error.what();
  }
  line.Clear();
  if (command.json) {
    fmt::print("{}\n", nlohmann::ordered_json::parse(outcome.predictor.training_json).dump(2));
  } else {
    PrintReport(data, outcome);
    fmt::print("\npredictor: {}\n", command.out);
    if (picture_trouble.empty()) fmt::print("picture: {}.svg (and .png)\n", picture.string());
    fmt::print("next: strainwave predict {} RECORD, or strainwave export {} --out DIR\n", command.out,
               command.out);
  }
  if (picture_trouble.empty()) return static_cast<int>(ExitCode::kDone);
  fmt::print(stderr, "error: no pictures: {}\n", picture_trouble);
  return static_cast<int>(ExitCode::kMachineFailed);
}

}  // namespace

void AddTrain(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("train",
                         "Train a predictor of transmission error and stiffness from the vibration of "
                         "campaigns, and show what it is "
                         "worth beside simpler ones.\n"
                         "Example: strainwave train campaigns/first campaigns/second --out predictor");
  auto options = std::make_shared<TrainCommand>();
  command->add_option("DIR", options->folders, "campaign folders, of one reducer or several")->required();
  command->add_option("--out", options->out, "folder of the predictor")->required();
  command->add_option("--outputs", options->outputs,
                      "results to predict (default: all of e_max, e_avg, K1, K2, K3 that there are)");
  command->add_option("--design", options->job.design, "small, or the paper's ann and cnn")
      ->capture_default_str();
  command->add_option("--epochs", options->job.epochs, "default: as the design says")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--members", options->job.members, "networks in the ensemble; default: as the design says")
      ->check(CLI::PositiveNumber);
  command->add_option("--folds", options->job.folds, "of the calibration of the intervals")
      ->check(CLI::Range(2, 100))
      ->capture_default_str();
  command->add_option("--coverage", options->job.coverage, "of the intervals")
      ->check(CLI::Range(0.01, 0.999))
      ->capture_default_str();
  command
      ->add_option("--correlation", options->job.correlation_limit,
                   "features alike to more than this fall out")
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  command->add_option("--wavelet", options->wavelet, "haar, db1 to db20, sym2 to sym20, coif1 to coif5")
      ->capture_default_str();
  command->add_option("--levels", options->levels, "of the decomposition")
      ->check(CLI::Range(1, 20))
      ->capture_default_str();
  command->add_option("--seed", options->job.seed, "of weights, batches and the random split")
      ->capture_default_str();
  command->add_flag("--json", options->json, "print the report as one JSON document");
  command->callback([options, &action] { action = [options] { return Run(*options); }; });
}

}  // namespace strainwave::bench
