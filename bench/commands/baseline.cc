// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>

#include "bench/commands/commands.h"
#include "bench/commands/output.h"
#include "bench/errors/bench_error.h"
#include "bench/errors/output_path.h"
#include "bench/prediction/exported_predictor.h"
#include "bench/prediction/predictor_file.h"
#include "bench/prediction/reducer_baseline.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

struct BaselineCommand {
  std::string predictor;
  std::vector<std::string> paths;
  std::string out;
};

ReducerBaseline Read(const BaselineCommand& command) {
  const std::vector<std::filesystem::path> paths(command.paths.begin(), command.paths.end());
  if (std::filesystem::exists(std::filesystem::path(command.predictor) / kExportedRecipe)) {
    const ExportedPredictor exported(command.predictor);
    return ReadReducerBaseline(paths, exported.recipe(), exported.outputs());
  }
  const Predictor predictor = ReadPredictor(command.predictor);
  return ReadReducerBaseline(paths, predictor.recipe, predictor.outputs);
}

int Run(const BaselineCommand& command) {
  DemandOutputFile(command.out);
  const ReducerBaseline baseline = Read(command);
  daq::WriteFileAtomically(command.out, BaselineText(baseline));
  ToStdout("{}: {}, {} records:", command.out,
           baseline.specimen.empty() ? "a reducer without a name" : baseline.specimen, baseline.records);
  for (std::size_t i = 0; i < baseline.outputs.size(); ++i) {
    ToStdout(" {} {:.5g}", baseline.outputs[i], baseline.means.values(static_cast<Eigen::Index>(i)));
  }
  ToStdout("\n");
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void AddBaseline(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "baseline",
      "Keep what one reducer was like at its first measurements, for a predictor trained with --baseline:\n"
      "means of features and of what was measured. `predict` and `monitor` then add to it what vibration\n"
      "says has changed.\n"
      "Example: strainwave baseline predictor campaigns/second --out second.json");
  auto options = std::make_shared<BaselineCommand>();
  command->add_option("PREDICTOR", options->predictor, "folder that train or export has written")->required();
  command
      ->add_option("PATH", options->paths,
                   "its campaign, or its labelled vibration records, first ones first")
      ->required();
  command->add_option("--out", options->out, "the baseline file (JSON)")->required();
  command->callback([options, &action] { action = [options] { return Run(*options); }; });
}

}  // namespace strainwave::bench
