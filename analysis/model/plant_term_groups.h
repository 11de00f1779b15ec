// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "analysis/model/plant_terms.h"

/// The groups that the table of all terms is put together from: `…Causes` what a nominal plant does not have,
/// with sizes of zero, the others what it has.
namespace strainwave::analysis::model {

void AddGear(PlantParameters& p, std::vector<BoundTerm>& terms);
void AddGearCauses(PlantParameters& p, std::vector<BoundTerm>& terms);
void AddFriction(PlantParameters& p, std::vector<BoundTerm>& terms);
void AddDriveCauses(PlantParameters& p, std::vector<BoundTerm>& terms);
void AddBench(PlantParameters& p, std::vector<BoundTerm>& terms);
void AddMeasuringChain(PlantParameters& p, std::vector<BoundTerm>& terms);
void AddMeasuringCauses(PlantParameters& p, std::vector<BoundTerm>& terms);
void AddLife(PlantParameters& p, std::vector<BoundTerm>& terms);
void AddVibration(PlantParameters& p, std::vector<BoundTerm>& terms);
void AddVibrationCauses(PlantParameters& p, std::vector<BoundTerm>& terms);

/// A magnitude that vanishes when its term is off.
inline BoundParameter Amount(std::string_view name, std::string_view unit, double& value) {
  return {name, unit, &value, 0.0};
}

/// The same where it cannot be negative.
inline BoundParameter Size(std::string_view name, std::string_view unit, double& value) {
  return {.name = name, .unit = unit, .value = &value, .off = 0.0, .not_negative = true};
}

/// A nonlinear parameter of the term (a time, a phase, a position), which stays as it is when the term is
/// off.
inline BoundParameter Nonlinear(std::string_view name, std::string_view unit, double& value) {
  return {name, unit, &value, value};
}

/// The same where it divides, so that it must be positive.
inline BoundParameter Scale(std::string_view name, std::string_view unit, double& value) {
  return {name, unit, &value, value, true};
}

}  // namespace strainwave::analysis::model
