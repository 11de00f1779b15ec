// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string>

#include "analysis/diagnosis/hysteresis/record.h"

namespace strainwave::analysis::diagnosis {

/// A hysteresis test as a phase of a schedule.
struct LoopPhase {
  const char* name;
  double peak_share{1.0};  // of T3
  double torque_rate_Nm_per_s{1.0};
  double hold_s{0.5};
  int loops{3};
  const char* lock_angles{"0 deg"};
};

/// One line of YAML, as `run` takes it.
inline std::string PhaseText(const LoopRecords& records, const LoopPhase& phase) {
  return fmt::format(
      "- {{kind: hysteresis, name: {}, peak_torque: {:.4g} Nm, torque_rate: {:.3g} Nm/s, hold: {:.3g} s, "
      "loops: {}, "
      "lock_angles: {}}}\n",
      phase.name, phase.peak_share * records.t3_Nm, phase.torque_rate_Nm_per_s, phase.hold_s, phase.loops,
      phase.lock_angles);
}

/// Several loops at two angles of the locked input.
inline std::string TwoAngles(const LoopRecords& records) {
  return fmt::format(
      "# several loops at two angles of the locked input: what is the gear's own changes with it\n{}",
      PhaseText(records, {.name = "two-angles", .loops = 4, .lock_angles = "[0 deg, 90 deg]"}));
}

}  // namespace strainwave::analysis::diagnosis
