// SPDX-License-Identifier: Apache-2.0

#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/commands/commands.h"
#include "bench/commands/output.h"
#include "bench/errors/bench_error.h"
#include "bench/errors/output_path.h"
#include "bench/prediction/export_predictor.h"
#include "bench/prediction/network_worth.h"
#include "bench/prediction/onnx_model.h"

namespace strainwave::bench {
namespace {

struct ExportCommand {
  std::string predictor;
  std::string out;
  bool anyway{};
};

int Run(const ExportCommand& command) {
  DemandOutputFolder(command.out);
  const Predictor predictor = ReadPredictor(command.predictor);
  const auto training = nlohmann::ordered_json::parse(predictor.training_json);
  if (IsWorthNothing(training) && !command.anyway) {
    throw BenchError(ExitCode::kWrongInput,
                     fmt::format("{}: error: {} Nothing was written (expected a predictor that is worth "
                                 "something, or --anyway)",
                                 command.predictor, WorthSentence(training)));
  }
  const ExportSummary summary = ExportPredictor(predictor, command.out);
  ToStdout(
      "{}: network, {} kB, opset {}; input features 1 × {}, outputs {} 1 × {}, distance\n"
      "{}: how a record becomes features, and the intervals\n"
      "{}: model card (and .json)\n"
      "read back by OpenCV dnn: agrees to {:.1e} of each output, {:.1e} of its error\n",
      (summary.folder / "model.onnx").string(), summary.onnx_bytes / 1000, kOnnxOpset, summary.inputs,
      summary.classes ? "probability" : "prediction and half_width", summary.outputs,
      (summary.folder / "recipe.json").string(), (summary.folder / "model_card.md").string(),
      summary.disagreement_of_value, summary.disagreement_of_residual);
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void AddExport(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "export",
      "Write what a production monitor needs: the network as ONNX, the feature recipe, and a model card.\n"
      "Example: strainwave export predictor --out monitor");
  auto options = std::make_shared<ExportCommand>();
  command->add_option("PREDICTOR", options->predictor, "folder that train has written")->required();
  command->add_option("--out", options->out, "folder of the exported predictor")->required();
  command->add_flag("--anyway", options->anyway,
                    "also a network that its training found to be worth nothing");
  command->callback([options, &action] { action = [options] { return Run(*options); }; });
}

}  // namespace strainwave::bench
