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
constexpr double kLinePartOfCell = 0.3;    // that tells a strong line's order
// Of what stands at the harmonics beside a line: −ln p that nobody takes for noise, and beyond the part of
// the line's power that a resonance lets through there.
constexpr double kPlainlyObservable = 10.0;
constexpr double kPartBesideLine = 0.01;

// Orders that other things have: a multiple of the half turn, as looseness and misalignment make them, and
// one of a crack's. The nearest of each.
std::array<double, 2> OtherOrders(double order, double crack_order) {
  return {0.5 * std::round(2.0 * order), crack_order * std::round(order / crack_order)};
}

// Harmonics that a resonance makes observable: those within `reach` of `centre`.
struct Observable {
  double centre{};
  double half_width{};

  double reach() const { return kResonanceReach * half_width; }
  // Of the response, from one impulse to the next: exponent of its envelope.
  double decay() const { return kTwoPi * half_width; }
};
Observable ObservableOf(const VibrationResidual& residual, const VibrationTerm& train) {
  const double turn_Hz = residual.samples().runs.front().mean_speed_rad_per_s / kTwoPi;
  const double centre = train.nonlinear_parameters[1] / (train.nonlinear_parameters[0] * turn_Hz);
  return {centre, train.nonlinear_parameters[2] * centre};
}

// One harmonic alone, at a whole order: any order that divides it may be meant, and teeth make such lines.
// But they have none at the harmonics beside it, which stand at no whole orders: a resonance that is narrow
// lets little of these through, and where the impulses are large enough they are seen all the same.
bool IsALineOfTeeth(const VibrationResidual& residual, const Observable& observable, double order) {
  const double largest = std::max(1.0, std::round(observable.centre));
  if (std::abs(observable.centre - largest) + observable.reach() >= 1.0) return false;
  const VibrationSpectrum& spectrum = residual.over_turns();
  const double line = largest * order;
  if (std::abs(line - std::round(line)) >= kLinePartOfCell * spectrum.cell()) return false;
  const double beside = spectrum.At(line - order) + spectrum.At(line + order);
  const double cells = 2.0 * static_cast<double>(spectrum.channels());
  return ExcessOf(beside - kPartBesideLine * spectrum.At(line), cells) < kPlainlyObservable;
}

// Harmonics and sidebands of an order may all be at whole ones, as those of 14/3 are: it is the shaft that
// impacts.
bool AreOfTheShaft(const VibrationResidual& residual, const VibrationTerm& lines) {
  const double sharpness = kLinePartOfCell * residual.over_turns().cell();
  return std::ranges::all_of(lines.lines, [&](const LineOrder& line) {
    const double order = line.harmonic * lines.nonlinear_parameters[0] + line.offset;
    return std::abs(order - std::round(order)) < sharpness;
  });
}

// How many harmonics of its order say where it is. Lines that are as near to each other as sidebands of whole
// orders say by what they span how far apart they are, and by where they stand nothing: sidebands stand
// anywhere. Those farther apart are harmonics, counted from zero.
double HarmonicsOf(const VibrationResidual& residual, const VibrationTerm& term) {
  if (term.form == VibrationForm::kImpulseTrain) {
    const Observable observable = ObservableOf(residual, term);
    const double lowest = term.nonlinear_parameters[0] > kFarthestSideband
                              ? 0.0
                              : std::max(0.0, observable.centre - observable.reach());
    return std::max(1.0, observable.centre + observable.reach() - lowest);
  }
  const auto [lowest, highest] = std::ranges::minmax(term.lines, {}, &LineOrder::harmonic);
  // The order itself counts from zero.
  const auto is_first = [](const LineOrder& line) { return line.harmonic == 1.0 && line.offset == 0.0; };
  const double from = std::ranges::any_of(term.lines, is_first) ? 0.0 : lowest.harmonic;
  return std::max(1.0, highest.harmonic - from);
}

}  // namespace

bool IsBearingOrder(const VibrationResidual& residual, double order, double harmonics, double slip) {
  const double of_scale = kScaleRange * residual.samples().order_uncertainty * order;
  const double sharpness = std::max({of_scale, kPartOfCell * residual.over_turns().cell() / harmonics, slip});
  const std::array<double, 2> others = OtherOrders(order, model::CrackOrder(residual.samples().ratio));
  return std::ranges::none_of(others, [&](double other) { return std::abs(order - other) < sharpness; });
}

bool IsBearing(const VibrationResidual& residual, const VibrationTerm& term) {
  if (term.form == VibrationForm::kLines && AreOfTheShaft(residual, term)) return false;
  if (term.form == VibrationForm::kImpulseTrain) {
    const Observable observable = ObservableOf(residual, term);
    if (observable.decay() < 0.9 * kLeastDecay ||
        IsALineOfTeeth(residual, observable, term.nonlinear_parameters[0]))
      return false;
  }
  if (!term.slips.empty()) {
    return IsBearingOrder(residual, term.nonlinear_parameters[0], kHarmonicsOfSlipping,
                          kSlipRange * OrderErrorOfSlips(residual.samples(), term));
  }
  return IsBearingOrder(residual, term.nonlinear_parameters[0], HarmonicsOf(residual, term));
}

}  // namespace strainwave::analysis::diagnosis
