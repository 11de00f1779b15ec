// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace strainwave::analysis::joint_dynamics {

/// Smoothing, and derivatives, by the polynomial that fits a window of samples best.
struct SavitzkyGolay {
  int window{};  // samples, odd
  int order{};   // of the polynomial, below the window
  /// window × window: row k gives the value at the k-th sample of a window. The middle row is the filter; the
  /// rows about it are for the ends of a series, which are told by the first and the last window's
  /// polynomial: nothing is padded.
  Eigen::MatrixXd smoothing;
  Eigen::MatrixXd slope;  // the same for the derivative, by one sample
};

/// @throws std::invalid_argument unless the window is odd and greater than the order, and the order is from 1
/// up.
///
/// Source: docs/sources.md#savitzky-1964; the ends as in docs/sources.md#gorry-1990.
SavitzkyGolay MakeSavitzkyGolay(int window, int order);

/// As many values as the series has, each smoothed.
/// @throws std::invalid_argument if the series is shorter than the window.
std::vector<double> Smoothed(const SavitzkyGolay& filter, std::span<const double> series);

/// The derivative by time of the same polynomials.
/// @param step_s  from sample to sample.
std::vector<double> Derivative(const SavitzkyGolay& filter, std::span<const double> series, double step_s);

/// What a sine of this frequency is multiplied by in the middle of a series; of unit sampling rate.
double ResponseAt(const SavitzkyGolay& filter, double cycles_per_sample);

/// The lowest frequency at which a sine loses half of its power (−3 dB), in cycles a sample.
double HalfPowerFrequency(const SavitzkyGolay& filter);

}  // namespace strainwave::analysis::joint_dynamics
