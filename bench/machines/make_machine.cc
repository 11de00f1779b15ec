// SPDX-License-Identifier: Apache-2.0
#include "bench/machines/make_machine.h"

#include "bench/configuration/sensors_of.h"
#include "bench/machines/field/field_machine.h"
#include "bench/machines/plant_model_of.h"
#include "bench/machines/simulated_machine.h"

namespace strainwave::bench {

std::unique_ptr<BenchMachine> MakeMachine(const BenchDescription& description, const SimulatedTest& test,
                                          const AskOperator& ask) {
  if (!description.simulated) return std::make_unique<FieldMachine>(description, test.ratio, ask);
  SimulatedBenchSettings settings;
  settings.seed = description.simulation.seed;
  settings.time_skew_s = description.simulation.time_skew_s;
  settings.pace = test.pace;
  settings.has_accelerometers = SensorsOf(description).vibration;
  return std::make_unique<SimulatedMachine>(PlantModelOf(description, test.ratio), settings, test);
}

}  // namespace strainwave::bench
