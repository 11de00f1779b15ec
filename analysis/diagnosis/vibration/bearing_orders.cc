// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/bearing_orders.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/diagnosis/vibration/slipping.h"
#include "analysis/model/vibration_orders.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kFarthestSideband = 6.0;  // orders from a line that is none of the shaft's to its last one
constexpr double kPartOfCell = 0.6;        // that tells two orders apart
constexpr double kSlipRange = 2.5;         // standard errors
constexpr double kLinePartOfCell = 0.3;    // that tells a strong line's place
// Of what stands at the harmonics beside a line: −ln p that nobody takes for noise, and beyond the part of
// the line's power that a ring lets through there.
constexpr double kPlainlyHeard = 10.0;
constexpr double kPartBesideLine = 0.01;

// Orders that other things have: a multiple of the half turn, as looseness and misalignment make them, and
// one of a crack's. The nearest of each.
std::array<double, 2> OtherOrders(double order, double crack_order) {
  return {0.5 * std::round(2.0 * order), crack_order * std::round(order / crack_order)};
}

// Harmonics that a ring makes heard: those within `reach` of `centre`.
struct Heard {
  double centre{};
  double half_width{};

  double reach() const { return kRingReach * half_width; }
  // Of the ring, from one impulse to the next: exponent of its envelope.
  double decay() const { return kTwoPi * half_width; }
};
Heard HeardOf(const VibrationRemainder& remainder, const VibrationTerm& ring) {
  const double turn_Hz = remainder.samples().runs.front().mean_speed_rad_per_s / kTwoPi;
  const double centre = ring.shapes[1] / (ring.shapes[0] * turn_Hz);
  return {centre, ring.shapes[2] * centre};
}

// One harmonic alone, at a whole order: any order that divides it may be meant, and teeth make such lines.
// But they have none at the harmonics beside it, which stand at no whole orders: a ring that is narrow lets
// little of these through, and where the impulses are loud enough they are seen all the same.
bool IsALineOfTeeth(const VibrationRemainder& remainder, const Heard& heard, double order) {
  const double loudest = std::max(1.0, std::round(heard.centre));
  if (std::abs(heard.centre - loudest) + heard.reach() >= 1.0) return false;
  const VibrationSpectrum& spectrum = remainder.over_turns();
  const double line = loudest * order;
  if (std::abs(line - std::round(line)) >= kLinePartOfCell * spectrum.cell()) return false;
  const double beside = spectrum.At(line - order) + spectrum.At(line + order);
  const double cells = 2.0 * static_cast<double>(spectrum.channels());
  return ExcessOf(beside - kPartBesideLine * spectrum.At(line), cells) < kPlainlyHeard;
}

// Harmonics and sidebands of an order may all be at whole ones, as those of 14/3 are: it is the shaft that
// knocks.
bool AreOfTheShaft(const VibrationRemainder& remainder, const VibrationTerm& lines) {
  const double sharpness = kLinePartOfCell * remainder.over_turns().cell();
  return std::ranges::all_of(lines.lines, [&](const LinePlace& line) {
    const double order = line.harmonic * lines.shapes[0] + line.offset;
    return std::abs(order - std::round(order)) < sharpness;
  });
}

// How many harmonics of its order say where it is. Lines that are as near to each other as sidebands of whole
// orders say by what they span how far apart they are, and by where they stand nothing: sidebands stand
// anywhere. Those farther apart are harmonics, counted from zero.
double HarmonicsOf(const VibrationRemainder& remainder, const VibrationTerm& term) {
  if (term.form == VibrationForm::kRing) {
    const Heard heard = HeardOf(remainder, term);
    const double lowest =
        term.shapes[0] > kFarthestSideband ? 0.0 : std::max(0.0, heard.centre - heard.reach());
    return std::max(1.0, heard.centre + heard.reach() - lowest);
  }
  const auto [lowest, highest] = std::ranges::minmax(term.lines, {}, &LinePlace::harmonic);
  // The order itself counts from zero.
  const auto is_first = [](const LinePlace& line) { return line.harmonic == 1.0 && line.offset == 0.0; };
  const double from = std::ranges::any_of(term.lines, is_first) ? 0.0 : lowest.harmonic;
  return std::max(1.0, highest.harmonic - from);
}

}  // namespace

bool IsBearingOrder(const VibrationRemainder& remainder, double order, double harmonics, double slip) {
  const double of_scale = kScaleRange * remainder.samples().order_uncertainty * order;
  const double sharpness =
      std::max({of_scale, kPartOfCell * remainder.over_turns().cell() / harmonics, slip});
  const std::array<double, 2> others = OtherOrders(order, model::CrackOrder(remainder.samples().ratio));
  return std::ranges::none_of(others, [&](double other) { return std::abs(order - other) < sharpness; });
}

bool IsBearing(const VibrationRemainder& remainder, const VibrationTerm& term) {
  if (term.form == VibrationForm::kLines && AreOfTheShaft(remainder, term)) return false;
  if (term.form == VibrationForm::kRing) {
    const Heard heard = HeardOf(remainder, term);
    if (heard.decay() < 0.9 * kLeastDecay || IsALineOfTeeth(remainder, heard, term.shapes[0])) return false;
  }
  if (!term.slips.empty()) {
    return IsBearingOrder(remainder, term.shapes[0], kHarmonicsOfSlipping,
                          kSlipRange * OrderErrorOfSlips(remainder.samples(), term));
  }
  return IsBearingOrder(remainder, term.shapes[0], HarmonicsOf(remainder, term));
}

}  // namespace strainwave::analysis::diagnosis
