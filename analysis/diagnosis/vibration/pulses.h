// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <span>

#include "analysis/diagnosis/vibration/samples.h"

namespace strainwave::analysis::diagnosis {

/// Smooth pulses at even angles, without their mean: Gaussian bells whose harmonics fall off as
/// exp(−(2π · width · k)² / 2). They change as 1 + cosine · cos(slow θ) + sine · sin(slow θ).
struct PulseTrain {
  double order{};  // pulses per input turn
  double width{};  // standard deviation of a bell, in distances of two pulses
  double place{};  // pulse where angle from mid-record · order / 2π = integer + place
  double slow_order{};
  double cosine{};
  double sine{};
};

inline constexpr int kPulseHarmonics = 12;

/// Harmonics of a train with this width that lie below half the sampling rate and are not lost in the first.
int PulseHarmonics(double width, double order, double highest_order);

Eigen::VectorXd PulseColumn(const VibrationRun& run, const PulseTrain& train, double highest_order);

/// Place at which an even train of this width explains most of a residual of one run, over its channels
/// together.
double BestPulsePlace(const VibrationRun& run, const PulseTrain& train, double highest_order,
                      std::span<const double> residual, std::span<const double> weights);

}  // namespace strainwave::analysis::diagnosis
