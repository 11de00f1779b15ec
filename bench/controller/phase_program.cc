// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/phase_program.h"

#include <cmath>

#include "analysis/units.h"

namespace strainwave::bench {

double HomeInput_rad(const Readings& readings, double ratio) noexcept {
  const double home_output_rad = kTwoPi * std::round(readings.output_angle_rad / kTwoPi);
  const double near_rad = readings.input_angle_rad + ratio * (home_output_rad - readings.output_angle_rad);
  return kTwoPi * std::round(near_rad / kTwoPi);
}

double DriveAhead_rad(const Readings& readings, const ServoDrive& driving) noexcept {
  return driving.Actual().position_rad - readings.input_angle_rad;
}

bool BroughtUp(ServoDrive& drive) noexcept {
  const DriveActual actual = drive.Actual();
  if (actual.power != protocols::PowerState::kOperationEnabled) return false;
  // Also where it is told to be off already: one that tells its brake wrongly is found by what it tells then.
  drive.SetBrake(false);
  return !actual.brake_engaged;
}

}  // namespace strainwave::bench
