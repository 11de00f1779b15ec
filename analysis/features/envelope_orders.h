// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/features/order_bands.h"

namespace strainwave::analysis::features {

/// Bands of half an order about each whole and half order, from 0.5 up to 20 or as far as the envelope of a
/// signal of so many samples a turn reaches; empty where it reaches less than two of them.
OrderBands EnvelopeOrderBands(double samples_per_turn);

/// What repeats how often a turn: the envelope of a signal (the magnitude of the analytic signal of all that
/// lies above a twelfth of the Nyquist frequency, where a bearing's impacts ring), its spectrum under a Hann
/// window over whole the record, and of that the share of each band of orders, as a natural logarithm. Shares
/// know neither the gain of the sensor nor how loud the machine is; orders do not move with its speed.
///
/// @param signal  even in time, at constant speed; at least 4 turns; finite.
/// @param samples_per_turn  of the shaft that carries the bearing.
/// @return one value a band; NaN for a band that the sampling does not reach. A share below 1e-12 counts as
///   that.
/// @throws std::invalid_argument if the signal is too short, or edges do not rise.
///
/// Source: docs/sources.md#randall-2011.
std::vector<double> EnvelopeOrderShares(std::span<const double> signal, double samples_per_turn,
                                        const OrderBands& bands);

/// `CHANNEL.envelope_orders.LOW_HIGH`, channel by channel.
std::vector<std::string> EnvelopeOrderNames(std::span<const std::string> channels, const OrderBands& bands);

}  // namespace strainwave::analysis::features
