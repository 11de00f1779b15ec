// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <mutex>
#include <stdexcept>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/commands/commands.h"
#include "bench/commands/fingerprint_report.h"
#include "bench/commands/output.h"
#include "bench/commands/terminal.h"
#include "bench/errors/bench_error.h"
#include "bench/errors/output_path.h"
#include "bench/fingerprint/classify_file.h"
#include "bench/fingerprint/export_fingerprints.h"
#include "bench/fingerprint/fingerprint_file.h"
#include "bench/fingerprint/fingerprint_json.h"
#include "bench/fingerprint/fingerprint_names.h"
#include "bench/fingerprint/fingerprint_pictures.h"
#include "bench/plots/gnuplot.h"
#include "bench/prediction/onnx_model.h"

namespace strainwave::bench {
namespace {

namespace dynamics = analysis::joint_dynamics;
using dynamics::Fingerprint, dynamics::Method;

struct FingerprintTrainCommand {
  std::string folder;
  std::string out;
  double window_s{-1.0};
  int order{3};
  std::string fingerprint{"joint"};
  std::string method;
  std::string healthy;
  FingerprintJob job;
  bool json{};
};

Fingerprint FingerprintOf(const std::string& name) {
  try {
    return FingerprintKindNamed(name);
  } catch (const std::invalid_argument&) {
    Refuse("--fingerprint", fmt::format("'{}' is no fingerprint", name), "joint, group or tensor");
  }
}

Method MethodOf(const std::string& name) {
  try {
    return AttributionMethodNamed(name);
  } catch (const std::invalid_argument&) {
    Refuse("--method", fmt::format("'{}' is no method", name), "exact, kernel or gradients");
  }
}

int TrainFingerprintModel(FingerprintTrainCommand command) {
  DemandOutputFolder(command.out);
  command.job.fingerprint = FingerprintOf(command.fingerprint);
  if (!command.method.empty()) command.job.method = MethodOf(command.method);
  if (command.job.method == Method::kGradients && command.job.fingerprint == Fingerprint::kJoint)
    Refuse("--method", "expected gradients are of single inputs", "--fingerprint group or tensor with it");
  FingerprintDataSettings settings;
  settings.smoothing.order = command.order;
  settings.healthy = command.healthy;
  if (command.window_s >= 0.0) settings.smoothing = {command.window_s, command.order, true};
  ShareLine line;
  constexpr double kShareOfReading = 0.1;
  std::mutex telling;
  const auto told = [&](double from, double to) {
    return [&, from, to](const std::string& step, double share) {
      const std::lock_guard lock(telling);
      line.Show(step, from + (to - from) * share);
    };
  };
  const FingerprintData data = ReadFingerprintData(command.folder, settings, told(0.0, kShareOfReading));
  FingerprintOutcome outcome = TrainFingerprints(data, command.job, told(kShareOfReading, 1.0));
  const nlohmann::ordered_json report = TrainingJsonOf(data, command.job, outcome);
  outcome.model->training_json = report.dump();
  WriteFingerprintModel(command.out, *outcome.model);
  std::string picture_trouble;
  std::vector<std::filesystem::path> pictures;
  try {
    pictures = DrawFingerprints(data, outcome, command.out);
  } catch (const GnuplotError& error) {
    picture_trouble = error.what();
  }
  line.Clear();
  for (const auto& warning : report.at("warnings")) ToStderr("warning: {}\n", warning.get<std::string>());
  if (command.json) {
    ToStdout("{}\n", report.dump(2));
  } else {
    PrintFingerprintTraining(data, outcome);
    ToStdout("\n");
    for (const auto& picture : pictures) ToStdout("picture: {}.svg (and .png)\n", picture.string());
    ToStdout("model: {}\nnext: strainwave fingerprint classify {} RECORD\n", command.out, command.out);
  }
  if (picture_trouble.empty()) return static_cast<int>(ExitCode::kDone);
  ToStderr("error: no pictures: {}\n", picture_trouble);
  return static_cast<int>(ExitCode::kMachineFailed);
}

struct FingerprintClassifyCommand {
  std::string model;
  std::vector<std::string> paths;
  bool json{};
};

int ClassifyFiles(const FingerprintClassifyCommand& command) {
  const FingerprintModel model = ReadFingerprintModel(command.model);
  nlohmann::ordered_json verdicts = nlohmann::ordered_json::array();
  const std::vector<std::filesystem::path> files = JointRecordPaths(command.paths);
  ShareLine line;
  for (std::size_t i = 0; i < files.size(); ++i) {
    line.Show("explaining " + FileText(files[i]), static_cast<double>(i) / static_cast<double>(files.size()));
    const FileVerdict verdict = ClassifyFile(model, files[i]);
    line.Clear();
    for (const std::string& warning : verdict.warnings)
      ToStderr("{}: warning: {}\n", verdict.file.string(), warning);
    verdicts.push_back(JsonOf(verdict, model));
    if (!command.json) PrintVerdict(verdict, model);
  }
  line.Clear();
  if (command.json) ToStdout("{}\n", verdicts.dump(2));
  return static_cast<int>(ExitCode::kDone);
}

struct FingerprintExportCommand {
  std::string model;
  std::string out;
};

int ExportFingerprintModel(const FingerprintExportCommand& command) {
  DemandOutputFolder(command.out);
  const FingerprintExport written = ExportFingerprints(ReadFingerprintModel(command.model), command.out);
  ToStdout(
      "{}: states to torques, {}: fingerprints to probabilities, opset {}\n{}: how a record becomes states "
      "and "
      "fingerprints\n{}: model card (and .json)\nread back by OpenCV dnn: agrees to {:.1e} of a torque's "
      "deviation and "
      "{:.1e} of probability\n",
      (written.folder / kNominalOnnx).string(), (written.folder / kClassifierOnnx).string(), kOnnxOpset,
      (written.folder / "recipe.json").string(), (written.folder / "model_card.md").string(),
      written.nominal_disagreement, written.classifier_disagreement);
  return static_cast<int>(ExitCode::kDone);
}

void AddFingerprintTrain(CLI::App& group, Action& action) {
  CLI::App* command = group.add_subcommand(
      "train",
      "Learn the dynamics of robot joints and tell faulty units from healthy ones by what explains their "
      "torques. DIR "
      "holds records of\nkind joints and labels.csv with file, unit, class, and where known origin.\n"
      "Example: strainwave fingerprint train arms --out model");
  auto options = std::make_shared<FingerprintTrainCommand>();
  command->add_option("DIR", options->folder, "folder of records with labels.csv")->required();
  command->add_option("--out", options->out, "folder of the model")->required();
  command
      ->add_option("--window", options->window_s,
                   "s of the Savitzky-Golay filter, an odd number of samples (default: the one nearest to "
                   "0.051 s); 501 "
                   "samples at 1 kHz are a low-pass of 2.1 Hz")
      ->check(CLI::PositiveNumber);
  command->add_option("--order", options->order, "of the filter's polynomial")
      ->check(CLI::Range(1, 9))
      ->capture_default_str();
  command
      ->add_option(
          "--fingerprint", options->fingerprint,
          "joint (a number a joint), group (a number an input) or tensor (each input on each torque)")
      ->capture_default_str();
  command->add_option(
      "--method", options->method,
      "exact Shapley values, kernel (Kernel SHAP) or gradients (default: exact up to 10 players)");
  command->add_option("--coalitions", options->job.coalitions,
                      "of Kernel SHAP (default: 2 for each player and 2048)");
  command->add_option("--samples", options->job.samples, "of each file that are explained")
      ->check(CLI::Range(10, 100000))
      ->capture_default_str();
  command
      ->add_option("--background", options->job.background,
                   "rows of healthy files that explanations start from")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command->add_option("--healthy", options->healthy,
                      "class that is no fault (default: the one that is called healthy, normal or the like)");
  command->add_option("--folds", options->job.folds, "of files, units and origins that are left out in turn")
      ->check(CLI::Range(2, 1000))
      ->capture_default_str();
  command->add_option("--epochs", options->job.epochs, "of the networks of the dynamics, at most")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--seed", options->job.seed, "of weights, batches and folds")->capture_default_str();
  command->add_flag("--json", options->json, "print the report as one JSON document");
  command->callback([options, &action] { action = [options] { return TrainFingerprintModel(*options); }; });
}

void AddFingerprintClassify(CLI::App& group, Action& action) {
  CLI::App* command = group.add_subcommand(
      "classify",
      "Tell how probable a fault is in records of joints, and which joints it comes from.\n"
      "Example: strainwave fingerprint classify model arms/001.csv");
  auto options = std::make_shared<FingerprintClassifyCommand>();
  command->add_option("MODEL", options->model, "folder that fingerprint train has written")->required();
  command->add_option("PATH", options->paths, "records of kind joints (CSV, HDF5), or folders of them")
      ->required();
  command->add_flag("--json", options->json, "an array with an object for each file");
  command->callback([options, &action] { action = [options] { return ClassifyFiles(*options); }; });
}

void AddFingerprintExport(CLI::App& group, Action& action) {
  CLI::App* command = group.add_subcommand(
      "export",
      "Write both networks of a model as ONNX, the recipe of its fingerprints, and a model card.\n"
      "Example: strainwave fingerprint export model --out exported");
  auto options = std::make_shared<FingerprintExportCommand>();
  command->add_option("MODEL", options->model, "folder that fingerprint train has written")->required();
  command->add_option("--out", options->out, "folder of the exported model")->required();
  command->callback([options, &action] { action = [options] { return ExportFingerprintModel(*options); }; });
}

}  // namespace

void AddFingerprint(CLI::App& app, Action& action) {
  CLI::App* group = app.add_subcommand(
      "fingerprint",
      "Faults of robot joints, told by what a network of their dynamics explains their torques with.");
  group->require_subcommand(1);
  AddFingerprintTrain(*group, action);
  AddFingerprintClassify(*group, action);
  AddFingerprintExport(*group, action);
}

}  // namespace strainwave::bench
