// SPDX-License-Identifier: Apache-2.0

#include <malloc.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "analysis/diagnosis/detection_power.h"
#include "analysis/diagnosis/diagnose.h"
#include "analysis/diagnosis/residuals.h"
#include "bench/campaign/folder.h"
#include "bench/campaign/on_all_processors.h"
#include "bench/commands/commands.h"
#include "bench/commands/map_option.h"
#include "bench/commands/output.h"
#include "bench/commands/tell_warnings.h"
#include "bench/commands/terminal.h"
#include "bench/diagnosis/diagnosis_json.h"
#include "bench/diagnosis/diagnosis_pictures.h"
#include "bench/diagnosis/diagnosis_text.h"
#include "bench/diagnosis/extended_model.h"
#include "bench/diagnosis/nominal_models.h"
#include "bench/diagnosis/power_report.h"
#include "bench/diagnosis/residual_views.h"
#include "bench/errors/bench_error.h"
#include "bench/plots/gnuplot.h"
#include "bench/utc.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;

struct DiagnoseCommand {
  std::vector<std::string> paths;
  std::string model;
  std::string out;
  RecordChoice choice;
  unsigned long long seed{1};
  bool details{};
  bool power{};
  std::string map;
  bool json{};
};

// What the diagnosis itself takes of the time; the rest are pictures.
constexpr double kShareOfFits = 0.8;

// Fits take and leave arrays of the record's length all the time: given back to the system each time, they
// cost a quarter of the diagnosis in pages that have to be cleared again.
void KeepFreedMemory() {
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
  mallopt(M_TOP_PAD, 16 << 20);
}

diagnosis::DiagnoseOptions OptionsOf(const StudyInput& input, const std::optional<ExtendedModel>& model,
                                     const DiagnoseCommand& command) {
  diagnosis::DiagnoseOptions options;
  options.seed = command.seed;
  options.parallel = OnAllProcessors;
  options.simulate = input.simulate;
  if (model) options.given_causes = GivenCauses(*model, *input.study, command.model);
  return options;
}

diagnosis::Diagnosis RunDiagnosis(const StudyInput& input, diagnosis::DiagnoseOptions options,
                                  const DiagnoseCommand& command, ShareLine& line) {
  options.progress = [&](const std::string& step, double share) {
    line.Show(step, share * (command.out.empty() ? 1.0 : kShareOfFits));
  };
  try {
    return diagnosis::Diagnose(*input.study, options);
  } catch (const std::invalid_argument& error) {
    throw BenchError(ExitCode::kWrongInput,
                     fmt::format("{}: error: {}", input.records.front().file, error.what()));
  }
}

// A line of its own: how long it takes says nothing of how long the diagnosis took.
diagnosis::DetectionPower MeasurePower(const StudyInput& input, const diagnosis::Diagnosis& result,
                                       diagnosis::DiagnoseOptions options) {
  ShareLine line;
  options.progress = [&](const std::string& step, double share) { line.Show(step, share); };
  return diagnosis::MeasureDetectionPower(*input.study, result, options);
}

// Each of some hundred records would be judged by up to 19 more.
void RefusePowerOfSimulation(const DiagnoseCommand& command) {
  if (command.power && command.choice.simulated)
    Refuse(command.paths.front(), "--power beside --judge-by-simulation", "one of the two");
}

std::optional<ExtendedModel> ReadModel(const DiagnoseCommand& command, StudyKind kind) {
  if (command.model.empty()) return std::nullopt;
  ExtendedModel model = ReadExtendedModel(command.model);
  if (model.kind != kind) {
    throw BenchError(ExitCode::kWrongInput,
                     fmt::format("{}: error: the model is of kind {}, the records of kind {} (expected one "
                                 "kind)",
                                 command.model, NameOf(model.kind), NameOf(kind)));
  }
  return model;
}

// The plant's terms of a model; what the simulated bench has no place for stays out with a word.
PlantMapping PlantOf(const ExtendedModel& model, const MappingContext& context) {
  if (model.kind == StudyKind::kCampaign) return {{}, {"the model of a campaign has no terms of the plant"}};
  try {
    PlantMapping plant = PlantTermsOf(model.kind, model.nominal, NamedCausesOf(model, false), context);
    for (const diagnosis::ParameterValue& number : model.nominal) {
      if (std::isinf(number.standard_error))
        plant.not_run.push_back(number.name + ": left open by the records; one value of many is taken");
    }
    return plant;
  } catch (const std::invalid_argument& error) {
    return {{}, {error.what()}};
  }
}

std::vector<RecordWarning> WarningsOfOpen(const diagnosis::Diagnosis& result, const StudyInput& input) {
  const std::string file = input.records.size() == 1 ? input.records.front().file : "";
  std::vector<RecordWarning> warnings;
  for (const std::string& words : result.open) warnings.push_back({file, 0, words});
  return warnings;
}

int Run(const DiagnoseCommand& command) {
  RefusePowerOfSimulation(command);
  KeepFreedMemory();
  ShareLine line;
  line.Show("reading " + FileText(command.paths.front()), 0.0);
  RecordChoice choice = command.choice;
  choice.reader = RecordReader(command.map);
  StudyInput input = ReadStudyInput(command.paths, choice);
  const std::optional<ExtendedModel> given = ReadModel(command, input.kind);
  TellWarnings(input.warnings);
  const diagnosis::DiagnoseOptions options = OptionsOf(input, given, command);
  diagnosis::Diagnosis result = RunDiagnosis(input, options, command, line);
  result.notes.insert(result.notes.begin(), input.notes.begin(), input.notes.end());
  const std::vector<RecordWarning> open = WarningsOfOpen(result, input);
  TellWarnings(open);
  input.warnings.insert(input.warnings.end(), open.begin(), open.end());
  DiagnosisReport report{
      input, result, command.model, given ? given->nominal : DataSheetParameters(input.kind), {}};
  if (result.verdict == diagnosis::Verdict::kUnnamedStructure) {
    const std::vector<double> residual = diagnosis::ResidualsOf(*input.study, result.nominal);
    report.formula = diagnosis::ProposeFormula(
        *input.study,
        Eigen::Map<const Eigen::VectorXd>(residual.data(), static_cast<Eigen::Index>(residual.size())),
        result.weights, command.seed);
  }
  const auto start = std::chrono::steady_clock::now();
  if (command.power) {
    line.Clear();
    report.power = MeasurePower(input, result, options);
  }
  const std::chrono::duration<double> planting = std::chrono::steady_clock::now() - start;
  const nlohmann::ordered_json document = DiagnosisJson(report);
  std::string files;
  std::string picture_trouble;
  if (!command.out.empty()) {
    const std::filesystem::path folder = command.out;
    std::filesystem::create_directories(folder);
    ExtendedModel model = ExtendedModelOf(input, result, UtcNow());
    model.plant = PlantOf(model, input.mapping);
    daq::WriteFileAtomically(folder / "extended_model.yaml", ExtendedModelText(model));
    daq::WriteFileAtomically(folder / "diagnosis.json", document.dump(2) + "\n");
    std::vector<std::filesystem::path> pictures;
    try {
      pictures = DrawDiagnosis(report, folder, [&](double share) {
        line.Show("pictures", kShareOfFits + (1.0 - kShareOfFits) * share);
      });
    } catch (const GnuplotError& error) {
      picture_trouble = error.what();
    }
    files = FilesText(folder / "extended_model.yaml", pictures);
  }
  line.Clear();
  command.json ? ToStdout("{}\n", document.dump(2))
               : ToStdout("{}{}{}", DiagnosisText(report, command.details),
                          PowerText(report, DurationText(planting.count())), files);
  if (picture_trouble.empty()) return static_cast<int>(ExitCode::kDone);
  ToStderr("error: no pictures: {}\n", picture_trouble);
  return static_cast<int>(ExitCode::kMachineFailed);
}

}  // namespace

void AddDiagnose(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "diagnose",
      "Show what the simulation gets wrong about measured records of one kind, name the cause, write the "
      "extended model, and measure the gain.\n"
      "Example: strainwave diagnose loop.csv --out diagnosis");
  auto options = std::make_shared<DiagnoseCommand>();
  command
      ->add_option(
          "RECORD", options->paths,
          "record files (CSV, HDF5), fitted together; or one campaign folder: its results cycle by cycle")
      ->required();
  command->add_option("--model", options->model,
                      "extended_model.yaml to go on from: its causes count as known");
  command->add_option("--out", options->out,
                      "folder for extended_model.yaml, diagnosis.json and the pictures (SVG and PNG)");
  command->add_option("--kind", options->choice.kind, "of files with records of several kinds: the one meant")
      ->check(CLI::IsMember({"transmission_error", "hysteresis", "motion", "vibration"}));
  command->add_option("--group", options->choice.group,
                      "of HDF5 files: only records with this in the name of their group");
  command->add_option("--seed", options->seed, "of the bootstrap")->capture_default_str();
  command->add_flag("--details", options->details, "with the numbers of every line and every channel");
  command->add_flag(
      "--judge-by-simulation", options->choice.simulated,
      "of motion: a cause is named only if records of an axis in closed loop, simulated without it, "
      "do not show as much; takes up to 20 times as long");
  command->add_flag("--power", options->power,
                    "how large each effect has to be in these records to be found nine times of ten: each is "
                    "planted into them at growing size, and searched for; takes some hundred times as long");
  AddMapOption(*command, options->map);
  command->add_flag("--json", options->json, "the diagnosis as JSON on standard output");
  command->callback([options, &action] { action = [options] { return Run(*options); }; });
}

}  // namespace strainwave::bench
