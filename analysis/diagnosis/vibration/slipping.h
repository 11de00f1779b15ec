// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>

#include "analysis/diagnosis/vibration/starts.h"

/// Impulses of a bearing whose balls slip: each comes a percent or two of the period early or late, and all
/// that follow with it. After a few of them the response is out of step, and no line at a harmonic is left;
/// but its size still comes and goes with the order (Randall & Antoni, Mech. Syst. Signal Process. 25 (2011)
/// 485).
namespace strainwave::analysis::diagnosis {

/// A train whose impulses slip, of the order with which the envelope of a response comes and goes, where that
/// is beyond chance. First record only, where it is the only one.
/// @param allowed  says which orders count
std::optional<TermFit> SearchSlippingTrain(const VibrationResidual& residual, std::size_t index,
                                           double lowest, double highest,
                                           const std::function<bool(double order)>& allowed);

/// Root mean square of what the impulses slip, each against the one before.
double SlipShareOf(std::span<const double> slips);

/// Standard error of a train's order by what its impulses slip, which adds up.
double OrderErrorOfSlips(const VibrationSamples& samples, const VibrationTerm& train);

/// Logarithm of how many locations the impulses of a train that slips were chosen from: to half a period of
/// the resonance, as far as they slip. 0 for even impulses.
double LogSearchLocationsOfSlips(const VibrationSamples& samples, const VibrationTerm& train);

/// BIC of a train with what these locations cost.
double BicWithSlips(const VibrationSamples& samples, const TermFit& train);

}  // namespace strainwave::analysis::diagnosis
