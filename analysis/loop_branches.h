// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "analysis/transmission_error.h"

namespace strainwave::analysis {

/// A segment of a record in which one signal goes one way: samples first..last, both included. Neighbouring
/// branches share the sample of the reversal.
struct Branch {
  std::size_t first{};
  std::size_t last{};
  bool rising{};

  bool operator==(const Branch&) const = default;
};

/// Splits a signal at its reversals. A reversal counts once the signal has gone back by more than
/// `threshold`.
std::vector<Branch> SplitBranches(std::span<const double> signal, double threshold);

/// The signal made monotone in each branch, as near to it as least squares allows (isotonic regression, pool
/// adjacent violators). What is monotone already is returned unchanged, bit for bit.
std::vector<double> MonotoneWithinBranches(std::span<const double> signal, std::span<const Branch> branches);

/// Twist of one branch at a torque, by a straight line twist(torque) through the samples within ±window of
/// the level, widened until it holds 4 samples that are as far apart as a fifth of the window (those of a
/// hold have no slope); none if the level is more than `reach` outside the branch's torques, or passed where
/// samples are missing. The standard error is that of the line; from 20 samples on it holds under
/// autocorrelated noise.
std::optional<Estimate> TwistAtTorque(std::span<const double> torque_Nm, std::span<const double> twist_rad,
                                      const Branch& branch, double level_Nm, double window_Nm,
                                      double reach_Nm);

}  // namespace strainwave::analysis
