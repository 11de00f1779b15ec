// SPDX-License-Identifier: Apache-2.0

#include <memory>

#include <CLI/CLI.hpp>

#include "bench/campaign/campaign_error.h"
#include "bench/commands/commands.h"
#include "bench/commands/output.h"
#include "bench/prediction/export_predictor.h"
#include "bench/prediction/onnx_model.h"

namespace strainwave::bench {
namespace {

struct ExportCommand {
  std::string predictor;
  std::string out;
};

int Run(const ExportCommand& command) {
  const ExportSummary summary = ExportPredictor(ReadPredictor(command.predictor), command.out);
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
  command->callback([options, &action] { action = [options] { return Run(*options); }; });
}

}  // namespace strainwave::bench
