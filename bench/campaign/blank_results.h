// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "bench/campaign/journal.h"
#include "bench/campaign/record_results.h"
#include "bench/controller/phase_program.h"

namespace strainwave::bench {

/// Calibrations that a blank test gives: the compliance in series with the gear (docs/effects.md E17) and the
/// first two harmonics of the output encoder's error (E18).
inline constexpr std::array kBlankCalibrations{"series_compliance_rad_per_Nm", "output_encoder_cosine_1_rad",
                                               "output_encoder_sine_1_rad",    "output_encoder_cosine_2_rad",
                                               "output_encoder_sine_2_rad",    "output_encoder_residual_rad"};

/// From the records of a blank test, "…/blank_hysteresis_1" and "…/blank_transmission_error"; empty without
/// them.
std::vector<Calibration> BlankCalibrations(std::span<const NamedRecord> records);

/// Puts calibrations of these names into the corrections; others are left alone.
void Apply(std::span<const Calibration> calibrations, BenchCorrections& corrections);

}  // namespace strainwave::bench
