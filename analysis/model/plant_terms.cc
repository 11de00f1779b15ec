// SPDX-License-Identifier: Apache-2.0
#include "analysis/model/plant_terms.h"

#include "analysis/model/plant_term_groups.h"

namespace strainwave::analysis::model {

std::vector<BoundTerm> BindTerms(PlantParameters& parameters) {
  std::vector<BoundTerm> terms;
  AddGear(parameters, terms);
  AddFriction(parameters, terms);
  AddBench(parameters, terms);
  AddMeasuringChain(parameters, terms);
  AddLife(parameters, terms);
  AddVibration(parameters, terms);
  AddGearCauses(parameters, terms);
  AddDriveCauses(parameters, terms);
  AddMeasuringCauses(parameters, terms);
  AddVibrationCauses(parameters, terms);
  return terms;
}

}  // namespace strainwave::analysis::model
