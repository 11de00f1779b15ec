// SPDX-License-Identifier: Apache-2.0

#include <cmath>
#include <filesystem>
#include <memory>
#include <set>

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/commands/commands.h"
#include "bench/commands/map_option.h"
#include "bench/commands/output.h"
#include "bench/commands/tell_warnings.h"
#include "bench/commands/terminal.h"
#include "bench/errors/bench_error.h"
#include "bench/prediction/predictor_file.h"
#include "bench/prediction/record_features.h"
#include "bench/prediction/record_labels.h"
#include "bench/prediction/record_prediction.h"

namespace strainwave::bench {
namespace {

struct PredictCommand {
  std::string predictor;
  std::string baseline;
  std::vector<std::string> paths;
  OperatingPoint given;  // under what the reducer ran, where a record does not tell it
  std::string map;
  bool json{};
};

// What was measured, where the record carries it.
double Measured(const daq::Record& record, const std::string& output) {
  return LabelOf(record, output).value_or(std::nan(""));
}

void PrintHead(const daq::Record& record, const RecordPrediction& predicted) {
  ToStdout("{}{}{}", record.source.file, record.source.group.empty() ? "" : " ", record.source.group);
  if (predicted.windows > 1) ToStdout(", {} windows", predicted.windows);
  if (predicted.outside()) {
    ToStdout(": outside what the predictor was trained on ({}): not valid",
             OutsideText(predicted.distance, predicted.left));
  }
  ToStdout("\n");
}

nlohmann::ordered_json ValuesReport(const daq::Record& record, const Predictor& predictor,
                                    const RecordPrediction& predicted, bool print) {
  nlohmann::ordered_json values;
  for (std::size_t i = 0; i < predictor.outputs.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const double value = predicted.value(column);
    const double half_width = predicted.half_width(column);
    const double measured = Measured(record, predictor.outputs[i]);
    nlohmann::ordered_json entry{{"value", value}, {"low", value - half_width}, {"high", value + half_width}};
    if (std::isfinite(measured)) entry["measured"] = measured;
    values[predictor.outputs[i]] = std::move(entry);
    if (!print) continue;
    ToStdout("  {:<20} {:>12.5g}", predictor.outputs[i], value);
    if (!predicted.outside()) ToStdout(" ± {:.3g}", half_width);
    if (std::isfinite(measured)) ToStdout("   measured {:.5g}", measured);
    ToStdout("\n");
  }
  return {{"coverage", predictor.fitted.band.coverage}, {"values", std::move(values)}};
}

nlohmann::ordered_json ClassReport(const daq::Record& record, const Predictor& predictor,
                                   const RecordPrediction& predicted, bool print) {
  Eigen::Index likely = 0;
  predicted.value.maxCoeff(&likely);
  nlohmann::ordered_json probabilities;
  for (std::size_t i = 0; i < predictor.outputs.size(); ++i) {
    const double probability = predicted.value(static_cast<Eigen::Index>(i));
    probabilities[predictor.outputs[i]] = probability;
    if (print) ToStdout("  {:<20} {:>8.4f}\n", predictor.outputs[i], probability);
  }
  const std::string& name = predictor.outputs[static_cast<std::size_t>(likely)];
  nlohmann::ordered_json report{{"class", name}, {"probabilities", std::move(probabilities)}};
  const auto own = ClassOf(record);
  if (own) report["measured"] = *own;
  if (print) ToStdout("  class: {}{}\n", name, own ? fmt::format("   own class {}", *own) : "");
  return report;
}

nlohmann::ordered_json ReportOf(const daq::Record& record, const Predictor& predictor,
                                const RecordPrediction& predicted, bool print) {
  if (print) PrintHead(record, predicted);
  nlohmann::ordered_json report{
      {"kind", "prediction"}, {"record", record.source.file}, {"group", record.source.group}};
  report.update(predictor.classes() ? ClassReport(record, predictor, predicted, print)
                                    : ValuesReport(record, predictor, predicted, print));
  report["windows"] = predicted.windows;
  report["distance"] = predicted.distance;
  report["outside_training"] = predicted.outside();
  report["outside"] = predicted.left;
  return report;
}

int Run(const PredictCommand& command) {
  RecordPredictor predictor(command.predictor, command.baseline);
  const RecordReader reader(command.map);
  nlohmann::ordered_json reports = nlohmann::ordered_json::array();
  std::set<std::string> told;
  ShareLine line;
  double done = 0.0;
  for (const std::string& path : command.paths) {
    const double share = done++ / static_cast<double>(command.paths.size());
    line.Show("reading " + FileText(path), share);
    for (const daq::Record& record : ReadVibrationRecords(path, predictor.motor_torque(), reader)) {
      std::vector<RecordWarning> warnings = WarningsOf(record);
      TellWarnings(warnings);
      line.Show("predicting from " + FileText(path), share);
      RecordPrediction predicted = predictor.Predict(record, command.given);
      for (const std::string& text : predicted.unknown) {
        RecordWarning warning{record.source.file, 0, text};
        if (told.insert(warning.text).second) TellWarnings({&warning, 1});
        warnings.push_back(std::move(warning));
      }
      reports.push_back(ReportOf(record, predictor.predictor(), predicted, !command.json));
      reports.back()["warnings"] = WarningTexts(warnings);
    }
  }
  line.Clear();
  if (command.json) ToStdout("{}\n", (reports.size() == 1 ? reports.front() : reports).dump(2));
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void AddPredict(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "predict",
      "Predict transmission error and stiffness from vibration records, each with its "
      "interval, or the probability\nof each class, and say when a record lies outside what was "
      "trained on.\n"
      "Example: strainwave predict predictor campaigns/second/cycles/000100.h5");
  auto options = std::make_shared<PredictCommand>();
  command->add_option("PREDICTOR", options->predictor, "folder that train has written")->required();
  command->add_option("PATH", options->paths, "vibration records: CSV, HDF5, files of a campaign's cycles")
      ->required();
  command->add_option(
      "--baseline", options->baseline,
      "what the reducer was like at first, as `baseline` writes it, for a predictor of changes");
  const auto given = [&](const char* name, OperatingQuantity quantity, const char* what) {
    command->add_option_function<double>(
        name, [options, quantity](double value) { options->given[quantity] = std::abs(value); }, what);
  };
  given("--output-torque", OperatingQuantity::kOutputTorque,
        "Nm at the output, where a record does not tell it (metadata or column output_torque_Nm)");
  given("--input-speed", OperatingQuantity::kInputSpeed,
        "rpm of the input shaft, where a record does not tell it (input_speed_rpm)");
  command->add_option_function<double>(
      "--temperature", [options](double value) { options->given[OperatingQuantity::kTemperature] = value; },
      "degC of the gear, where a record does not tell it (temperature_degC)");
  AddMapOption(*command, options->map);
  command->add_flag("--json", options->json, "one object a record; several as an array");
  command->callback([options, &action] { action = [options] { return Run(*options); }; });
}

}  // namespace strainwave::bench
