// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "analysis/model/plant_parameters.h"

namespace strainwave::analysis::model {

/// One number of a term. The name ends in its unit ("k1_Nm_per_rad"); `unit` is the same for tables.
struct TermParameter {
  std::string name;
  double value{};
  std::string unit;
};

/// One named physical effect.
struct Term {
  std::string name;
  std::string effect;  // a row of docs/effects.md ("E5"), or empty
  bool enabled{true};
  std::vector<TermParameter> parameters;
};

/// The plant as a list of named terms, as it stands in a model file: switch a term off, leave it out, change
/// a number, and compile. A term that is left out is off; a parameter that is left out has its default.
struct PlantModel {
  double ratio{80.0};
  std::vector<Term> terms;
};

/// Every known term with its default magnitudes.
PlantModel DefaultPlantModel();

/// The term, or the parameter of a term, by name.
/// @throws std::invalid_argument naming the unknown one and the known ones.
Term& FindTerm(PlantModel& model, std::string_view name);
double& FindParameter(PlantModel& model, std::string_view term, std::string_view parameter);

/// The list as the struct that is computed with.
/// @throws std::invalid_argument for a term or parameter that is unknown (with the known ones) or given
///   twice, for a value that is not finite, not positive where it divides, and for a ratio that is not above
///   1 (both encoders are counted so that it is positive).
PlantParameters CompilePlantModel(const PlantModel& model);

}  // namespace strainwave::analysis::model
