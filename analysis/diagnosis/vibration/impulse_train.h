// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <complex>
#include <cstddef>
#include <vector>

#include "analysis/diagnosis/vibration/samples.h"

namespace strainwave::analysis::diagnosis {

/// Of a resonance: exp(pole · t) is what is left of it after a time, turned.
std::complex<double> ResonancePole(double resonance_Hz, double damping_ratio);

/// A change of the impulses with the input angle: 1 + cosine · cos(order θ) + sine · sin(order θ).
struct ImpulseModulation {
  double order{};
  double cosine{};
  double sine{};
};

/// Impulses at even angles, but for what they slip, each of which excites a resonance:
/// ∑ⱼ wⱼ exp(−ζω(t − tⱼ)) sin ω(t − tⱼ).
struct ImpulseTrain {
  double order{};  // impulses per input turn
  double resonance_Hz{};
  double damping_ratio{};
  double phase{};  // impulse where angle from mid-record · order / 2π = integer + phase
  std::vector<ImpulseModulation> modulations{};
  /// By how much of a period each impulse comes late, the one at mid-record in the middle; those beyond the
  /// ends as the last ones. Empty where none slips.
  std::vector<double> slips{};

  double SlipOf(double impulse) const;
};

/// The train with impulses of about one.
Eigen::VectorXd ImpulseTrainColumn(const VibrationRun& run, const ImpulseTrain& train);

/// Its slopes by order, resonance_Hz, damping_ratio, by cosine and sine of each modulation, and by phase.
Eigen::MatrixXd ImpulseTrainSlopes(const VibrationRun& run, const ImpulseTrain& train);

/// Adds a single response that starts at a time.
void AddTransient(const VibrationRun& run, double resonance_Hz, double damping_ratio, double start_s,
                  double height, Eigen::Ref<Eigen::VectorXd> column);

/// A single response of a sum of them, and its height there.
struct Impact {
  double start_s{};
  double height{1.0};
};

/// The response, about as late as the first of two of this frequency and damping, that both together are once
/// both have begun.
Impact OneOf(const Impact& first, const Impact& second, double resonance_Hz, double damping_ratio);

}  // namespace strainwave::analysis::diagnosis
