// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace strainwave::analysis::features {

/// How far the lines at some orders stand out of the spectrum of the envelope (envelope_orders.h), in dB: the
/// strongest within two hundredths of an order, as slip moves it, over the median of those within a fifth of
/// it.
/// @return one an order; NaN where the sampling or the length of the record does not tell it from its
///   neighbours.
/// @throws std::invalid_argument if a value is not finite, or an order or the samples a turn are not above 0,
///   or there are less than 4 turns.
std::vector<double> EnvelopeProminences_dB(std::span<const double> signal, double samples_per_turn,
                                           std::span<const double> orders);

}  // namespace strainwave::analysis::features
