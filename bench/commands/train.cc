// SPDX-License-Identifier: Apache-2.0

#include <memory>
#include <mutex>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "analysis/quantities.h"
#include "bench/commands/commands.h"
#include "bench/commands/map_option.h"
#include "bench/commands/output.h"
#include "bench/commands/tell_warnings.h"
#include "bench/commands/terminal.h"
#include "bench/commands/train_report.h"
#include "bench/errors/bench_error.h"
#include "bench/errors/output_path.h"
#include "bench/plots/gnuplot.h"
#include "bench/prediction/train_predictor.h"
#include "bench/prediction/training_pictures.h"

namespace strainwave::bench {
namespace {

struct TrainCommand {
  std::vector<std::string> paths;
  std::string out;
  std::string set{"wavelet"};
  SourceSettings sources;
  double window_s{-1.0};
  std::string specimen_per;
  TrainingJob job;
  std::string map;
  bool json{};
};

int Run(const TrainCommand& command) {
  if (command.out.empty() != command.job.compare_only) {
    throw BenchError(ExitCode::kWrongInput,
                     "error: a predictor is written somewhere or not at all (expected --out or --compare)");
  }
  if (!command.out.empty()) DemandOutputFolder(command.out);
  ShareLine line;
  // Reading is a tenth of the work where nothing is kept from before.
  constexpr double kShareOfReading = 0.1;
  SourceSettings settings = command.sources;
  settings.reader = RecordReader(command.map);
  settings.features.set = FeatureSetOf(command.set);
  if (command.window_s >= 0.0) settings.window_s = command.window_s;
  const TrainingData data = ReadTrainingData(
      {command.paths.begin(), command.paths.end()}, settings,
      command.specimen_per.empty() ? SpecimenPer::kGuessed : SpecimenPerOf(command.specimen_per),
      [&](const std::string& step, double share) { line.Show(step, kShareOfReading * share); });
  TellWarnings(data.warnings);
  std::mutex telling;
  const TrainingOutcome outcome =
      TrainPredictor(data, command.job, [&](const std::string& step, double share) {
        const std::lock_guard lock(telling);
        line.Show(step, kShareOfReading + (1.0 - kShareOfReading) * share);
        return true;
      });
  std::string picture_trouble;
  std::vector<std::filesystem::path> pictures;
  if (outcome.predictor) {
    WritePredictor(command.out, *outcome.predictor);
    try {
      pictures = DrawTraining(data, outcome, command.out);
    } catch (const GnuplotError& error) {
      picture_trouble = error.what();
    }
  }
  line.Clear();
  const auto report = nlohmann::ordered_json::parse(outcome.report_json);
  const std::string worth = WorthSentence(report);
  if (command.json) {
    ToStdout("{}\n", report.dump(2));
  } else {
    PrintTrainingReport(data, outcome);
    if (outcome.predictor) ToStdout("\npredictor: {}\n", command.out);
    for (const auto& picture : pictures) ToStdout("picture: {}.svg (and .png)\n", picture.string());
    if (outcome.predictor) {
      ToStdout("next: strainwave predict {} RECORD, or strainwave export {} --out DIR\n", command.out,
               command.out);
    }
    if (!worth.empty()) ToStdout("\n{}\n", worth);
  }
  if (command.json && !worth.empty()) ToStderr("warning: {}\n", worth);
  if (picture_trouble.empty()) return static_cast<int>(ExitCode::kDone);
  ToStderr("error: no pictures: {}\n", picture_trouble);
  return static_cast<int>(ExitCode::kMachineFailed);
}

}  // namespace

void AddTrain(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "train",
      "Train a predictor of transmission error and stiffness, or of a class, from the vibration "
      "of campaigns or of\nrecords that carry what was measured (metadata or columns k2_Nm_per_rad, "
      "e_max_arcmin, …, or class), and show\nwhat it is worth beside simpler ones.\n"
      "Example: strainwave train campaigns/first campaigns/second --out predictor\n"
      "         strainwave train bearings/ --out predictor --rate 12000 --channels accel_x_m_per_s2");
  auto options = std::make_shared<TrainCommand>();
  command
      ->add_option("PATH", options->paths,
                   "campaigns, of one reducer or several; vibration records (CSV, HDF5); folders of these")
      ->required();
  command->add_option("--out", options->out, "folder of the predictor");
  command->add_flag(
      "--compare", options->job.compare_only,
      "only compare, on the splits that do not flatter: no folds, no predictor, nothing written");
  command->add_option(
      "--outputs", options->sources.outputs,
      fmt::format("what to predict: quantities, or class (default: all of {} that there are, else class)",
                  analysis::Listed(analysis::kPredictedQuantities, &analysis::Quantity::symbol)));
  command->add_option("--set", options->set, "wavelet, or orders (energies by order of the input shaft)")
      ->capture_default_str()
      ->check(CLI::IsMember({"wavelet", "orders"}));
  command->add_option("--channels", options->sources.channels,
                      "columns to take (default: those of the first record)");
  command
      ->add_option("--rate", options->sources.sample_rate_hz,
                   "Hz; records at a whole multiple are brought down to it")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--window", options->window_s,
                   "seconds, rounded up to whole turns where the speed is known; 0: records whole (default: "
                   "records are cut where there are fewer than 200)")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option(
          "--specimen-per", options->specimen_per,
          "file or folder: what one specimen's records that do not name it are (default: folder, where there "
          "are several with several files)")
      ->check(CLI::IsMember({"file", "folder"}));
  command->add_flag("--motor-torque", options->sources.motor_torque,
                    "the motor's torque (from its current), logged beside the vibration, as a channel");
  command->add_option("--design", options->job.design, "small, or ann and cnn of Shivam et al.")
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
  command
      ->add_option(
          "--baseline", options->job.baseline_records,
          "records at the beginning of each reducer's life: what comes later is told as a change since "
          "these, so that reducers never seen can be followed; 0: none")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  command->add_flag("--search", options->job.search, "try widths, depths and weight decays by honest folds");
  command->add_flag("--learning-curve", options->job.learning_curve,
                    "how few measured records would do, chosen actively or evenly");
  command
      ->add_option("--wavelet", options->sources.features.wavelet.wavelet,
                   "haar, db1 to db20, sym2 to sym20, coif1 to coif5")
      ->capture_default_str();
  command->add_option("--levels", options->sources.features.wavelet.levels, "of the decomposition")
      ->check(CLI::Range(1, 20))
      ->capture_default_str();
  command->add_option("--seed", options->job.seed, "of weights, batches and the random split")
      ->capture_default_str();
  AddMapOption(*command, options->map);
  command->add_flag("--json", options->json, "print the report as one JSON document");
  command->callback([options, &action] { action = [options] { return Run(*options); }; });
}

}  // namespace strainwave::bench
