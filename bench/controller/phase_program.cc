// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/phase_program.h"

namespace strainwave::bench {

bool BroughtUp(ServoDrive& drive) noexcept {
  const DriveActual actual = drive.Actual();
  if (actual.power != protocols::PowerState::kOperationEnabled) return false;
  if (!actual.brake_engaged) return true;
  drive.SetBrake(false);
  return false;
}

}  // namespace strainwave::bench
