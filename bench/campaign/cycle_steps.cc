// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/cycle_steps.h"

#include <fmt/core.h>

#include "schedules/reader/plan.h"

namespace strainwave::bench {

bool IsMeasurement(const schedules::PhaseParameters& parameters) {
  return std::holds_alternative<schedules::MeasurementRotation>(parameters) ||
         std::holds_alternative<schedules::TransmissionErrorSweep>(parameters) ||
         std::holds_alternative<schedules::HysteresisTest>(parameters);
}

double PlannedDuration_s(const std::vector<CycleStep>& steps) {
  return steps.empty() ? 0.0 : steps.back().begins_s + steps.back().planned_s;
}

std::vector<CycleStep> StepsOf(const schedules::Schedule& schedule, int cycle) {
  const schedules::Plan plan = schedules::MakePlan(schedule, {});
  std::vector<CycleStep> steps;
  const auto add = [&](const schedules::Phase& phase, const schedules::PhaseTime& time, std::string group) {
    const bool measurement = IsMeasurement(phase.parameters);
    const bool accumulates = std::holds_alternative<schedules::LoadRun>(phase.parameters);
    steps.push_back({static_cast<int>(steps.size()), &phase, std::move(group), measurement, accumulates,
                     PlannedDuration_s(steps), time.total_s()});
  };
  if (cycle > 0) {
    for (std::size_t i = 0; i < schedule.phases.size(); ++i) {
      add(schedule.phases[i], plan.phases[i], schedule.phases[i].name);
    }
    return steps;
  }
  for (std::size_t i = 0; i < schedule.preparation.size(); ++i) {
    add(schedule.preparation[i], plan.preparation[i], schedule.preparation[i].name);
  }
  for (int repeat = 1; repeat <= schedule.measurements.repeatability_repeats; ++repeat) {
    for (std::size_t i = 0; i < schedule.phases.size(); ++i) {
      const schedules::Phase& phase = schedule.phases[i];
      if (!IsMeasurement(phase.parameters)) continue;
      add(phase, plan.phases[i], fmt::format("repeat_{}/{}", repeat, phase.name));
    }
  }
  return steps;
}

}  // namespace strainwave::bench
