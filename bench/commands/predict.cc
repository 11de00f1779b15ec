// SPDX-License-Identifier: Apache-2.0

#include <cmath>
#include <filesystem>
#include <memory>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "bench/campaign/campaign_error.h"
#include "bench/commands/commands.h"
#include "bench/prediction/predictor_file.h"
#include "bench/prediction/recipe_inputs.h"
#include "bench/prediction/record_features.h"

namespace strainwave::bench {
namespace {

namespace prediction = analysis::prediction;

struct PredictCommand {
  std::string predictor;
  std::vector<std::string> paths;
  bool json{};
};

// What was measured, where the record carries it.
double Measured(const daq::Record& record, const std::string& output) {
  const auto text = record.Metadata(output);
  return text ? daq::NumberFromText(*text).value_or(std::nan("")) : std::nan("");
}

nlohmann::ordered_json ReportOf(const daq::Record& record, const Predictor& predictor,
                                const prediction::FittedPredictor::Prediction& predicted, bool print) {
  const double distance = predicted.distance(0);
  const bool outside = distance > 1.0;
  nlohmann::ordered_json values;
  if (print) {
    fmt::print(
        "{}{}{}{}\n", record.source.file, record.source.group.empty() ? "" : " ", record.source.group,
        outside ? fmt::format(": outside what the predictor was trained on ({:.1f} times the limit): do not "
                              "rely on these",
                              distance)
                : "");
  }
  for (std::size_t i = 0; i < predictor.outputs.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const double value = predicted.value(0, column);
    const double half_width = predicted.half_width(0, column);
    const double measured = Measured(record, predictor.outputs[i]);
    nlohmann::ordered_json entry{{"value", value}, {"low", value - half_width}, {"high", value + half_width}};
    if (std::isfinite(measured)) entry["measured"] = measured;
    values[predictor.outputs[i]] = std::move(entry);
    if (!print) continue;
    fmt::print("  {:<20} {:>12.5g} ± {:.3g}", predictor.outputs[i], value, half_width);
    if (std::isfinite(measured)) fmt::print("   measured {:.5g}", measured);
    fmt::print("\n");
  }
  return {{"kind", "prediction"},         {"record", record.source.file},
          {"group", record.source.group}, {"coverage", predictor.fitted.band.coverage},
          {"values", std::move(values)},  {"distance", distance},
          {"outside_training", outside}};
}

int Run(const PredictCommand& command) {
  const Predictor predictor = ReadPredictor(command.predictor);
  RecipeInputs inputs(predictor.recipe);
  nlohmann::ordered_json reports = nlohmann::ordered_json::array();
  for (const std::string& path : command.paths) {
    for (const daq::Record& record : ReadVibrationRecords(path)) {
      const auto predicted = predictor.fitted.Predict(inputs.Of(record));
      reports.push_back(ReportOf(record, predictor, predicted, !command.json));
    }
  }
  if (command.json) fmt::print("{}\n", (reports.size() == 1 ? reports.front() : reports).dump(2));
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void AddPredict(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("predict",
                         "Predict transmission error and stiffness from vibration records, each with its "
                         "interval, and say when a "
                         "record lies outside what was trained on.\n"
                         "Example: strainwave predict predictor campaigns/second/cycles/000100.h5");
  auto options = std::make_shared<PredictCommand>();
  command->add_option("PREDICTOR", options->predictor, "folder that train has written")->required();
  command->add_option("PATH", options->paths, "vibration records: CSV, HDF5, files of a campaign's cycles")
      ->required();
  command->add_flag("--json", options->json, "one object a record; several as an array");
  command->callback([options, &action] { action = [options] { return Run(*options); }; });
}

}  // namespace strainwave::bench
