// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace strainwave::analysis {

/// A value with the standard error of the procedure that made it.
struct Estimate {
  double value{};
  double standard_error{};
};

/// What the samples leave open.
inline constexpr Estimate kNotEstimated{std::numeric_limits<double>::quiet_NaN(),
                                        std::numeric_limits<double>::quiet_NaN()};

/// Angles of one sweep in one direction, sample by sample, already zeroed as the record asks.
struct AngleSweep {
  std::span<const double> input_angle_rad;   // at the motor shaft
  std::span<const double> output_angle_rad;  // same length
};

/// One line of the order spectrum of a transmission error.
struct OrderLine {
  double order_per_output_rev{};
  double order_per_input_rev{};
  Estimate amplitude_rad;  // NaN where the samples show a part of it that depends on its phase
  double phase_rad{};
  /// Named source where the order has one ("wave generator, 2nd harmonic"); else empty. Where two candidates
  /// appear at one order, both names, joined by " or ".
  std::string name;
  /// True when the sampling folds this order onto another one that the record could not tell apart;
  /// `alias_order_per_output_rev` is then where it appears.
  bool aliased{};
  double alias_order_per_output_rev{};
};

/// What one direction of a sweep says.
struct SweepError {
  std::vector<double> output_angle_rad;  // of the samples used: one full revolution
  std::vector<double> error_rad;         // input angle / ratio − output angle, same length
  Estimate e_avg_rad;                    // mean over the angle of the revolution
  Estimate e_max_rad;                    // max − min over the revolution
  double e_max_noise_bias_rad{};         // by how much noise alone widens e_max on average; not taken off
  double noise_rad{};                    // standard deviation of the harmonic regression's residual
  std::vector<OrderLine> orders;         // strongest first
};

/// Transmission error of a record with one or both directions.
struct TransmissionError {
  std::optional<SweepError> cw;
  std::optional<SweepError> ccw;
  std::optional<Estimate> lost_motion_rad;  // mean cw − ccw difference at equal output angle
  /// Checks that did not hold, in words; a number with a failed check is not to be stored as good.
  std::vector<std::string> failed_checks;
  /// What a reader of the orders should know: orders that appear elsewhere, candidates that share a line.
  std::vector<std::string> notes;
};

/// Computes the transmission error Δθ = θ_in / ratio − θ_out, its mean and range over one full revolution of
/// the output (docs/contract.md#transmission-error; docs/sources.md#shivam-2023, eq. 1 to 3), its order
/// spectrum by harmonic regression, and the lost motion between the directions.
///
/// The revolution: samples whose output travel from the sweep's first sample, in the sweep's own direction,
/// lies in [0, 2π) less a quarter of its usual step. A longer sweep gives its first revolution.
///
/// Orders: a constant and the known candidates (1 and 2 per output turn; 1, 2 and 4 per input turn; tooth
/// engagement, 2 · ratio + 2 per output turn), each at the order where the sampling makes it appear, and
/// every other integer order that stands out of the noise (false in one record of a hundred).
///
/// Means are over the angle (`mean_over_angle.h`): the harmonics' integral, and the trapezoid rule for what
/// they leave. Rows of a sweep that is sampled in time lie closer together wherever it is slow, and standing
/// still is no part of it.
///
/// Standard errors. The noise σ is the residual of that regression, with its degrees of freedom and its
/// autocorrelation. e_avg: about σ √∑w², σ/√n for even steps; if the angles are zero at the first sample
/// of either sweep, the noise of that one sample shifts all others, of both sweeps, and is added. e_max: root
/// of the mean square by which max − min under noise σ differs from max − min of the fitted curve, from the
/// distributions of the largest and the smallest of n independent normal values. Lost motion: both sweeps'
/// errors of the mean; the common zero falls out.
///
/// Checks: the wave generator's second harmonic seen by the steps; a full revolution covered; at least 36
/// steps, none of them longer than 15°; no sample that stands off all others alone; monotone; input and
/// output turn as the sign of the ratio says and by its size within 1 %; the two sweeps turn against each
/// other.
///
/// @param cw, ccw  the two sweeps; an empty one is a direction that was not measured.
/// @param ratio    signed, not zero.
/// @throws std::invalid_argument if lengths differ, a value is not finite, a sweep has fewer than 8 samples,
/// the ratio is
///   zero or not finite, or both sweeps are empty.
TransmissionError ComputeTransmissionError(const AngleSweep& cw, const AngleSweep& ccw, double ratio);

}  // namespace strainwave::analysis
