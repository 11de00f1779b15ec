// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "analysis/model/plant_parameters.h"

namespace strainwave::analysis::model {

/// Where a named parameter lives in the compiled struct, and at which value its term adds nothing.
struct BoundParameter {
  std::string_view name;
  std::string_view unit;
  double* value;
  double off;
  bool divides{};       // must be > 0
  bool not_negative{};  // must be ≥ 0
};

struct BoundTerm {
  std::string_view name;
  std::string_view effect;
  std::vector<BoundParameter> parameters;
  bool* flag{};  // for terms that switch a path rather than a magnitude
};

/// The one table of all terms, bound to `parameters`, which must outlive the result.
std::vector<BoundTerm> BindTerms(PlantParameters& parameters);

}  // namespace strainwave::analysis::model
