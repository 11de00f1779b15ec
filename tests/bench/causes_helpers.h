// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <initializer_list>
#include <string_view>

#include "bench/devices/simulated/gear_plant.h"
#include "tests/bench/simulated_helpers.h"

namespace strainwave::bench {

namespace model = analysis::model;
using Input = PlantCommands::Input;

struct Change {
  std::string_view term, parameter;
  double value;
};

// One specimen without what only spoils a comparison with a formula, but with these numbers.
inline model::PlantModel Quiet(std::initializer_list<Change> changes) {
  model::PlantModel description = ModelWithout(
      {"load_motor_ripple", "load_unbalance", "motor_cogging", "position_periodic_friction", "output_drag",
       "creep", "position_dependent_stiffness", "specimen_scatter", "seating_scatter", "motor_current_offset",
       "self_heating", "motor_heating", "day_and_night", "stribeck_friction", "load_torque_lag"});
  for (const Change& change : changes) {
    model::FindTerm(description, change.term).enabled = true;
    model::FindParameter(description, change.term, change.parameter) = change.value;
  }
  return description;
}

inline GearPlant Plant(std::initializer_list<Change> changes) {
  return GearPlant(model::CompilePlantModel(Quiet(changes)));
}

inline PlantCommands Locked(double load_Nm) {
  PlantCommands commands;
  commands.load_enabled = true;
  commands.load_brake = false;
  commands.load_torque_Nm = load_Nm;
  return commands;
}

inline PlantCommands Driven(Input input, double set_point, double load_Nm = 0.0) {
  PlantCommands commands = Locked(load_Nm);
  commands.input = input;
  commands.input_set_point = set_point;
  commands.input_brake = false;
  return commands;
}

inline void Hold(GearPlant& plant, const PlantCommands& commands, double time_s, double step_s = 0.01) {
  const int steps = static_cast<int>(std::lround(time_s / step_s));
  for (int i = 0; i < steps; ++i) plant.Step(commands, step_s);
}

}  // namespace strainwave::bench
