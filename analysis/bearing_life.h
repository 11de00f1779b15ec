// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "analysis/units.h"

namespace strainwave::analysis {

/// Rating of the wave-generator bearing and the overload limits of the flexspline. Defaults: CSF size 20,
/// ratio 80.
struct GearRating {
  double rated_torque_Nm = 34.0;                          // at the output
  double rated_speed_rad_per_s = RadPerSFromRpm(2000.0);  // at the input
  double l10_s = SecondsFromHours(7000.0);                // life that 90 of 100 reach at the rating
  double ratcheting_torque_Nm = 350.0;                    // at the output: teeth jump
  double buckling_torque_Nm = 330.0;                      // at the output: the flexspline's wall buckles
};

/// A segment of constant load.
struct LoadBlock {
  double output_torque_Nm{};       // either sign
  double input_speed_rad_per_s{};  // either sign
  double duration_s{};             // from 0 up
};

/// Life at a load: L₁₀ (T_r / T)³ (N_r / N), infinite without torque or speed.
/// Source: docs/effects.md#bearing-life; the maker's catalogue (docs/sources.md#hd-csf-csg).
/// @throws std::invalid_argument if the rating is not positive or the load not finite.
double LifeAtLoad_s(const GearRating& rating, double output_torque_Nm, double input_speed_rad_per_s);

/// Torque that wears the bearing as the blocks do: ∛(Σ n t |T|³ / Σ n t); 0 if nothing turns.
double AverageTorque_Nm(std::span<const LoadBlock> blocks);

/// Mean input speed over time, without sign: Σ n t / Σ t; 0 if no time passes.
double AverageSpeed_rad_per_s(std::span<const LoadBlock> blocks);

/// Share of L₁₀ that the blocks use up (Miner): Σ tᵢ / Lᵢ. 1 is the life that 90 of 100 bearings reach.
double LifeConsumed(const GearRating& rating, std::span<const LoadBlock> blocks);

/// How many times the peak torque the gear could bear.
struct OverloadMargins {
  double ratcheting{};
  double buckling{};
};

/// Limit over |peak|; infinite for a peak of zero.
OverloadMargins MarginsAtPeak(const GearRating& rating, double peak_output_torque_Nm);

}  // namespace strainwave::analysis
