// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/transmission_error.h"

namespace strainwave::analysis {

/// Torques and speeds of a steady rotation, sample by sample in time order. The input torque is what the
/// motor exerts on the gear, the output torque what the gear exerts on the load: power flows from the motor
/// when their products with the speeds are positive.
struct SteadyRotation {
  std::span<const double> input_torque_Nm;
  std::span<const double> input_speed_rad_per_s;
  std::span<const double> output_torque_Nm;
  std::span<const double> output_speed_rad_per_s;
};

/// Power out over power in, whichever side drives.
struct Efficiency {
  Estimate efficiency;
  bool back_driven{};       // the load drives
  double input_power_W{};   // into the gear at the input, from mean torque and mean speed
  double output_power_W{};  // out of the gear at the output
  /// Checks that did not hold, in words.
  std::vector<std::string> failed_checks;
};

/// Mean torque times mean speed on each side. The standard error holds under autocorrelated noise; that of
/// the speeds is left out where the speed is the same motion on both sides, so only the torques count.
/// @throws std::invalid_argument if lengths differ, a value is not finite, or there are fewer than 8 samples.
Efficiency MeasureEfficiency(const SteadyRotation& rotation);

/// Torque at which the speed leaves zero, in a torque ramp from standstill: the mean torque of the last
/// sample at rest and the first in motion. Motion begins with the first of three samples in a row beyond
/// `speed_threshold_rad_per_s` on one side. The standard error is the torque's noise and half the ramp's
/// step. None if nothing moves.
/// @throws std::invalid_argument if lengths differ, a value is not finite, there are fewer than 8 samples, or
/// the threshold is
///   not positive.
std::optional<Estimate> MeasureStartingTorque(std::span<const double> torque_Nm,
                                              std::span<const double> speed_rad_per_s,
                                              double speed_threshold_rad_per_s);

}  // namespace strainwave::analysis
