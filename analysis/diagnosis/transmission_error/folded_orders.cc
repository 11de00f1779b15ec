// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/transmission_error/folded_orders.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/diagnosis/scans.h"
#include "analysis/harmonic_regression.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Sweeps that are half a step apart see together what each alone does not.
bool AreOnOneGrid(const TransmissionErrorSamples& samples) {
  constexpr double kOff = 0.1;   // of a step
  constexpr double kFew = 0.05;  // of the samples
  if (!(samples.samples_per_turn > 0.0)) return false;
  const double step_rad = kTwoPi / samples.samples_per_turn;
  const auto off = std::ranges::count_if(samples.output_rad, [&](double angle_rad) {
    const double steps = (angle_rad - samples.output_rad.front()) / step_rad;
    return std::abs(steps - std::round(steps)) > kOff;
  });
  return static_cast<double>(off) <= kFew * static_cast<double>(samples.output_rad.size());
}

}  // namespace

std::string WhyNotSeen(const TransmissionErrorSamples& samples, double order,
                       const std::vector<NamedOrder>& others) {
  if (!AreOnOneGrid(samples)) return {};
  const double per_turn = samples.samples_per_turn;
  // Lines nearer than this are one over the turns that were measured.
  const double resolution = 0.5 / std::max(1.0, SpanOf(samples.output_rad) / kTwoPi);
  const double folded = FoldedOrder(order, per_turn);
  if (folded < resolution)
    return fmt::format("order {:.4g} is the same at each of {:.4g} samples a turn, as a constant", order,
                       per_turn);
  if (0.5 * per_turn - folded < resolution)
    return fmt::format("order {:.4g} is half of {:.4g} samples a turn: how much is seen hangs on its phase",
                       order, per_turn);
  for (const NamedOrder& other : others) {
    if (std::abs(FoldedOrder(other.order, per_turn) - folded) < resolution)
      return fmt::format("order {:.4g} and order {:.4g}, {}, are one line at {:.4g} samples a turn", order,
                         other.order, other.name, per_turn);
  }
  return {};
}

}  // namespace strainwave::analysis::diagnosis
