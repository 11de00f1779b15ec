// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/diagnose_steps.h"

#include <chrono>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "analysis/diagnosis/detection_power.h"
#include "analysis/diagnosis/residuals.h"
#include "bench/campaign/on_all_processors.h"
#include "bench/commands/output.h"
#include "bench/commands/tell_warnings.h"
#include "bench/diagnosis/diagnosis_json.h"
#include "bench/diagnosis/diagnosis_pictures.h"
#include "bench/diagnosis/diagnosis_text.h"
#include "bench/diagnosis/nominal_models.h"
#include "bench/errors/bench_error.h"
#include "bench/plots/gnuplot.h"
#include "bench/utc.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;

diagnosis::DiagnoseOptions OptionsOf(const StudyInput& input, const std::optional<ExtendedModel>& model,
                                     const DiagnoseCommand& command) {
  diagnosis::DiagnoseOptions options;
  options.seed = command.seed;
  options.parallel = OnAllProcessors;
  options.simulate = input.simulate;
  if (model) options.given_causes = GivenCauses(*model, *input.study, command.model);
  return options;
}

diagnosis::Diagnosis DiagnoseOrSay(const StudyInput& input, const diagnosis::DiagnoseOptions& options) {
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

// Of several specimens a warning that is of no one file says whose records it is about.
void TellWarningsOf(std::vector<RecordWarning> warnings, const std::string& specimen) {
  for (RecordWarning& warning : warnings)
    if (warning.file.empty() && !specimen.empty()) warning.text.insert(0, specimen + ": ");
  TellWarnings(warnings);
}

}  // namespace

DiagnosisReport FinishedDiagnosis::Report() const {
  return {input,   result, model_file, given ? given->nominal : DataSheetParameters(input.kind),
          formula, power};
}

FinishedDiagnosis DiagnoseInput(StudyInput input, const std::string& specimen, const DiagnoseCommand& command,
                                ShareLine& line, const StepProgress& progress) {
  FinishedDiagnosis finished{.input = std::move(input),
                             .given = {},
                             .result = {},
                             .formula = {},
                             .power = {},
                             .model_file = command.model};
  finished.given = ReadModel(command, finished.input.kind);
  TellWarningsOf(finished.input.warnings, specimen);
  diagnosis::DiagnoseOptions options = OptionsOf(finished.input, finished.given, command);
  options.progress = progress;
  diagnosis::Diagnosis& result = finished.result;
  result = DiagnoseOrSay(finished.input, options);
  result.notes.insert(result.notes.begin(), finished.input.notes.begin(), finished.input.notes.end());
  const std::vector<RecordWarning> open = WarningsOfOpen(result, finished.input);
  TellWarningsOf(open, specimen);
  finished.input.warnings.insert(finished.input.warnings.end(), open.begin(), open.end());
  if (result.verdict == diagnosis::Verdict::kUnnamedStructure) {
    const std::vector<double> residual = diagnosis::ResidualsOf(*finished.input.study, result.nominal);
    finished.formula = diagnosis::ProposeFormula(
        *finished.input.study,
        Eigen::Map<const Eigen::VectorXd>(residual.data(), static_cast<Eigen::Index>(residual.size())),
        result.weights, command.seed);
  }
  if (command.power) {
    line.Clear();
    const auto start = std::chrono::steady_clock::now();
    finished.power = MeasurePower(finished.input, result, options);
    finished.power_took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  return finished;
}

DiagnosisFiles WriteDiagnosis(const FinishedDiagnosis& finished, const std::filesystem::path& folder,
                              const std::function<void(double)>& progress) {
  const DiagnosisReport report = finished.Report();
  std::filesystem::create_directories(folder);
  ExtendedModel model = ExtendedModelOf(finished.input, finished.result, UtcNow());
  model.plant = PlantOf(model, finished.input.mapping);
  daq::WriteFileAtomically(folder / "extended_model.yaml", ExtendedModelText(model));
  daq::WriteFileAtomically(folder / "diagnosis.json", DiagnosisJson(report).dump(2) + "\n");
  DiagnosisFiles files;
  std::vector<std::filesystem::path> pictures;
  try {
    pictures = DrawDiagnosis(report, folder, progress);
  } catch (const GnuplotError& error) {
    files.picture_trouble = error.what();
  }
  files.text = FilesText(folder / "extended_model.yaml", pictures);
  return files;
}

int CodeOfPictures(const std::string& picture_trouble) {
  if (picture_trouble.empty()) return static_cast<int>(ExitCode::kDone);
  ToStderr("error: no pictures: {}\n", picture_trouble);
  return static_cast<int>(ExitCode::kMachineFailed);
}

}  // namespace strainwave::bench
