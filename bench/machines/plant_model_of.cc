// SPDX-License-Identifier: Apache-2.0
#include "bench/machines/plant_model_of.h"

#include <stdexcept>

#include "bench/configuration/read_bench_file.h"

namespace strainwave::bench {

analysis::model::PlantModel PlantModelOf(const BenchDescription& description, double ratio) {
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

}  // namespace strainwave::bench
