// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/model/plant_model.h"
#include "bench/diagnosis/plant_mapping.h"
#include "tests/bench/causes_helpers.h"

namespace strainwave::bench {

using analysis::diagnosis::ParameterValue;
using NamedCause = analysis::diagnosis::Study::NamedCause;

inline std::vector<ParameterValue> Values(std::initializer_list<std::pair<const char*, double>> named) {
  std::vector<ParameterValue> values;
  for (const auto& [name, value] : named) values.push_back({name, "", value, 0.0});
  return values;
}
inline NamedCause Cause(std::string name, std::initializer_list<std::pair<const char*, double>> parameters) {
  return {std::move(name), Values(parameters)};
}

// As a bench takes a plant file: on top of its own plant.
inline GearPlant PlantOf(const PlantMapping& mapping, std::initializer_list<std::string_view> without = {}) {
  model::PlantModel description = model::DefaultPlantModel();
  for (const std::string_view term : {"seating_scatter", "self_heating", "motor_heating", "day_and_night"}) {
    model::FindTerm(description, term).enabled = false;
  }
  for (const TermDescription& term : mapping.terms) {
    model::FindTerm(description, term.name).enabled = term.enabled;
    for (const auto& [name, value] : term.parameters)
      model::FindParameter(description, term.name, name) = value;
  }
  for (const std::string_view term : without) model::FindTerm(description, term).enabled = false;
  return GearPlant(model::DrawSpecimen(model::CompilePlantModel(description), 5));
}

}  // namespace strainwave::bench
