// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

namespace strainwave::analysis::features {

/// Edges of the bands, in orders (events a turn of the input shaft), rising. By default one band about each
/// of the first twelve orders, then bands that widen, up to four teeth beyond twice the meshing order of a
/// ratio of about 80.
struct OrderBands {
  std::vector<double> edges{0.5,  1.5,  2.5,  3.5,  4.5,  5.5,  6.5,  7.5,   8.5,   9.5,   10.5,
                            11.5, 12.5, 16.5, 24.5, 40.5, 64.5, 96.5, 144.5, 176.5, 240.5, 340.5};
};

/// @throws std::invalid_argument if there are fewer than two edges, one lies below 0, or they do not rise.
void RequireRisingEdges(const OrderBands& bands);

/// Mean square of the signal in each band of orders, from a mean of overlapping windowed spectra of about 16
/// turns each (Welch, Hann window); the mean of the signal is taken off first. The energies of all bands that
/// reach up to the Nyquist order add up to the variance of a stationary signal.
///
/// @param signal  even in time, at constant speed; at least 4 turns; finite.
/// @param samples_per_turn  of the input shaft.
/// @return one value a band in the square of the signal's unit; NaN for a band that the sampling does not
///   reach.
/// @throws std::invalid_argument if the signal is too short, or edges do not rise.
///
/// Source: Welch, IEEE Trans. Audio Electroacoustics 15 (1967) 70.
std::vector<double> OrderBandEnergies(std::span<const double> signal, double samples_per_turn,
                                      const OrderBands& bands);

/// `CHANNEL.orders.LOW_HIGH`, channel by channel.
std::vector<std::string> OrderBandNames(std::span<const std::string> channels, const OrderBands& bands);

}  // namespace strainwave::analysis::features
