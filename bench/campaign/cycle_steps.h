// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// One phase at its place in a cycle.
struct CycleStep {
  int index{};
  const schedules::Phase* phase{};  // of the schedule given
  std::string group;                // of its records in the cycle's file
  bool measurement{};               // taken again when a check fails
  bool accumulates{};               // what a cut attempt has served counts (load runs); else it begins anew
  double begins_s{};                // planned, since the cycle began
  double planned_s{};
};

/// The steps of a cycle. Cycle 0 is the preparation: the schedule's own preparation phases, then every
/// measurement `repeatability_repeats` times, in groups "repeat_N/PHASE". Empty when there is none.
std::vector<CycleStep> StepsOf(const schedules::Schedule& schedule, int cycle);

double PlannedDuration_s(const std::vector<CycleStep>& steps);

/// Load runs and soaks are not measurements.
bool IsMeasurement(const schedules::PhaseParameters& parameters);

}  // namespace strainwave::bench
