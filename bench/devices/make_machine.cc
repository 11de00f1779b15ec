// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/make_machine.h"

#include <fmt/core.h>

#include "bench/campaign/campaign_error.h"
#include "bench/configuration/read_bench_file.h"
#include "bench/devices/simulated_machine.h"

namespace strainwave::bench {
namespace {

// The nominal plant with what the bench file says differently.
analysis::model::PlantModel ModelOf(const BenchDescription& description, double ratio) {
  analysis::model::PlantModel model = analysis::model::DefaultPlantModel();
  model.ratio = ratio;
  schedules::FindingList findings;
  for (const TermDescription& term : description.simulation.terms) {
    try {
      analysis::model::FindTerm(model, term.name).enabled = term.enabled;
      for (const auto& [name, value] : term.parameters) {
        analysis::model::FindParameter(model, term.name, name) = value;
      }
    } catch (const std::invalid_argument& error) {
      findings.AddError(term.line, 1, error.what());
    }
  }
  if (findings.has_errors()) {
    const auto& simulation = description.simulation;
    throw BenchFileError(simulation.plant_file.empty() ? description.file_name : simulation.plant_file,
                         findings);
  }
  return model;
}

}  // namespace

std::unique_ptr<BenchMachine> MakeMachine(const BenchDescription& description, const SimulatedTest& test) {
  if (!description.simulated) {
    throw CampaignError(
        ExitCode::kMachineFailed,
        fmt::format("{}: error: this build drives no real devices yet (expected simulated: true)",
                    description.file_name));
  }
  SimulatedBenchSettings settings;
  settings.seed = description.simulation.seed;
  settings.time_skew_s = description.simulation.time_skew_s;
  settings.pace = test.pace;
  return std::make_unique<SimulatedMachine>(ModelOf(description, test.ratio), settings, test);
}

}  // namespace strainwave::bench
