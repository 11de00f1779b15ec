// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/resonances.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "analysis/diagnosis/vibration/bands.h"
#include "analysis/diagnosis/vibration/bearing_orders.h"
#include "analysis/diagnosis/vibration/bursts.h"
#include "analysis/diagnosis/vibration/families.h"
#include "analysis/diagnosis/vibration/transients.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Best = std::optional<TermFit>;

constexpr double kBandReach = 12.0;  // half-widths of a band in which its lines are
constexpr std::size_t kMostLinesOfBand = 3;
constexpr std::size_t kMostExcited = 2;
constexpr double kSameFrequency = 0.02;
constexpr double kAsGood = 5.0;   // of ln p
constexpr double kIsThere = 7.0;  // −ln p of a line, wherever it might have been, that would be named

VibrationTerm NarrowTerm(const VibrationResidual& residual, std::size_t index, const NoiseBand& band,
                         double damping) {
  VibrationTerm term;
  term.cause = index;
  term.form = VibrationForm::kNarrowband;
  term.observable.assign(residual.samples().channels(), 1);
  term.nonlinear_parameters = {band.centre_Hz, damping};
  term.nonlinear_parameters.insert(term.nonlinear_parameters.end(), band.sizes.begin(), band.sizes.end());
  return term;
}

// Channels in which the band is no larger than a few standard errors drop out.
TermFit DropUnobservable(const VibrationResidual& residual, TermFit solution) {
  bool changed = false;
  for (std::size_t c = 0; c < solution.channels.size() && solution.channels.size() > 1; ++c) {
    VibrationTerm fewer = solution.term;
    if (fewer.observable[c] == 0 || std::count(fewer.observable.begin(), fewer.observable.end(), 1) < 2)
      continue;
    fewer.observable[c] = 0;
    TermFit without = residual.With(std::move(fewer), 0);
    if (without.bic() > solution.bic()) continue;
    solution = std::move(without);
    changed = true;
  }
  return changed ? residual.Refine(std::move(solution), 4) : solution;
}

// Lines at whole orders or halfway between.
bool AreOfShaft(const VibrationTerm& lines, double cell) {
  return std::ranges::all_of(lines.lines, [&](const LineOrder& line) {
    const double doubled = 2.0 * (line.harmonic * lines.nonlinear_parameters[0] + line.offset);
    return std::abs(doubled - std::round(doubled)) < 2.0 * cell;
  });
}

// −ln p of what a term explains, by its numbers, less what a choice of search locations costs. BIC charges
// each channel's share of a band by the length of all, and would rather have a chance line in one channel.
double UnlikelinessOf(double likelihood_ratio, double numbers, double log_search_locations) {
  return ExcessOf(0.5 * likelihood_ratio, 0.5 * numbers) - log_search_locations;
}

double NumbersOf(const VibrationResidual& residual, const TermFit& fit) {
  return static_cast<double>(fit.free_parameters - residual.base().free_parameters);
}

// Lines of the shaft or of the current that stand together look like a band that noise drives, or beat like
// impacts; and a line alone is an impact that does not die away. They are lines where so few of them explain
// as much, under the noise that candidates are compared with: a band has something of its colour, too, and a
// line has not.
bool AreLines(const VibrationResidual& residual, const TermFit& band, SpectrumAxis axis) {
  const VibrationSamples& samples = residual.samples();
  const bool over_turns = axis == SpectrumAxis::kTurns;
  const VibrationSpectrum& spectrum = over_turns ? residual.over_turns() : residual.over_seconds();
  const double turn_Hz = over_turns ? samples.runs.front().mean_speed_rad_per_s / kTwoPi : 1.0;
  const double centre = band.term.nonlinear_parameters[0] / turn_Hz;
  const double reach = kBandReach * band.term.nonlinear_parameters[1] * centre + 2.0 * spectrum.cell();
  const double log_all_locations =
      std::log(2.0 * samples.runs.front().span_s() * std::min(samples.highest_Hz(), kHighestTorsional_Hz));
  const double of_band = residual.RatioOf(band);
  const double numbers_of_band = NumbersOf(residual, band);
  VibrationTerm lines;
  lines.cause = band.term.cause;
  lines.form = over_turns ? VibrationForm::kLines : VibrationForm::kTones;
  lines.observable.assign(samples.channels(), 1);
  for (const SpectrumPeak& peak :
       FindPeaks(spectrum, std::max(spectrum.cell(), centre - reach), centre + reach, kMostLinesOfBand)) {
    if (lines.nonlinear_parameters.empty()) lines.nonlinear_parameters = {peak.order};
    lines.lines.push_back({1.0, peak.order - lines.nonlinear_parameters[0]});
    const TermFit fit = residual.With(lines, 3);
    const std::size_t count = lines.lines.size();
    // A hum moves all channels in step, as a mode does: one phase, and what the others take from noise.
    const double in_step = count > 1 ? 0.0 : std::max(0.0, 0.5 * (NumbersOf(residual, fit) - 3.0));
    const double ratio = residual.RatioOf(fit) - in_step;
    const double numbers = NumbersOf(residual, fit) - in_step;
    // Where the others stand was chosen, too.
    const auto others = static_cast<double>(count - 1);
    double ahead{};
    if (band.term.form == VibrationForm::kNarrowband) {
      const double log_search_locations = others * std::log(2.0 * reach / spectrum.cell());
      ahead = UnlikelinessOf(ratio, numbers, log_search_locations) -
              UnlikelinessOf(of_band, numbers_of_band, 0.0);
    } else {
      ahead = 0.5 * (ratio - of_band - (numbers + others - numbers_of_band) * std::log(fit.weight_sum));
    }
    // One line is the simpler thing, unless it is chance itself; several are where the shaft makes them, or
    // have to be the better one.
    const bool of_shaft = over_turns && AreOfShaft(lines, spectrum.cell());
    const bool is_there = UnlikelinessOf(ratio, numbers, log_all_locations) > kIsThere;
    const bool simpler = of_shaft || (count == 1 && is_there);
    if (ahead > (simpler ? -kAsGood : 0.0)) return true;
  }
  return false;
}

// Over the angle the shaft's stand, over time those of the current, which a speed that wanders smears.
bool AreLines(const VibrationResidual& residual, const TermFit& band) {
  return (residual.samples().angle_known() && AreLines(residual, band, SpectrumAxis::kTurns)) ||
         AreLines(residual, band, SpectrumAxis::kSeconds);
}

double HalfWidthOf(const VibrationTerm& resonance) {
  return resonance.nonlinear_parameters[0] * resonance.nonlinear_parameters[1];
}

// A line's damping is no gear's, and would hide one that is.
void KeepDamped(TermFit fit, const ResonanceRange& range, Best& best) {
  if (fit.term.nonlinear_parameters[1] >= range.least_damping) Keep(std::move(fit), best);
}

void TryDriven(const VibrationResidual& residual, std::size_t index, const ResonanceRange& range,
               Best& best) {
  const VibrationSamples& samples = residual.samples();
  double slowest = 1e300;
  double fastest = 0.0;
  for (const VibrationRun& run : samples.runs) {
    const auto [low, high] = std::ranges::minmax(run.speed_rad_per_s);
    slowest = std::min(slowest, low / kTwoPi);
    fastest = std::max(fastest, high / kTwoPi);
  }
  if (fastest < (1.0 + kLeastSpeedSpread) * slowest) return;
  for (const double harmonic : {2.0, 1.0}) {
    Best own;
    const double from = std::max(range.lowest_Hz, 0.9 * harmonic * slowest);
    const double to = std::min(range.highest_Hz, 1.15 * harmonic * fastest);
    for (double natural = from; natural < to; natural *= 1.06) {
      VibrationTerm term;
      term.cause = index;
      term.form = VibrationForm::kDriven;
      term.observable.assign(samples.channels(), 1);
      term.lines = {{harmonic, 0.0}};
      term.nonlinear_parameters = {natural, 0.05};
      Keep(residual.With(std::move(term), 0), own);
    }
    if (!own) continue;
    *own = residual.Refine(std::move(*own), 12);
    VibrationTerm both = own->term;
    both.lines = {{1.0, 0.0}, {2.0, 0.0}};
    Keep(std::move(*own), best);
    Keep(residual.With(std::move(both), 6), best);
  }
}

}  // namespace

bool IsOfATrain(std::span<const VibrationTerm> terms, double frequency_Hz, double half_width_Hz) {
  return std::ranges::any_of(terms, [&](const VibrationTerm& term) {
    if (term.form != VibrationForm::kImpulseTrain) return false;
    const double half_width_of_resonance_Hz = term.nonlinear_parameters[1] * term.nonlinear_parameters[2];
    return std::abs(frequency_Hz - term.nonlinear_parameters[1]) <
           kResonanceReach * (half_width_of_resonance_Hz + half_width_Hz);
  });
}

bool HasResonanceOfATrain(std::span<const VibrationTerm> terms) {
  return std::ranges::any_of(terms, [&](const VibrationTerm& term) {
    const bool resonates = term.form == VibrationForm::kNarrowband || term.form == VibrationForm::kTransients;
    return resonates && IsOfATrain(terms, term.nonlinear_parameters[0], HalfWidthOf(term));
  });
}

Best SearchResonance(const VibrationResidual& residual, std::size_t index, const ResonanceRange& range) {
  Best best;
  std::vector<double> frequencies_Hz;
  const auto is_of_a_train = [&](double frequency_Hz) {
    return IsOfATrain(residual.base().terms, frequency_Hz, 0.0);
  };
  for (const NoiseBand& band : FindBands(residual, range.lowest_Hz, range.highest_Hz, 2)) {
    if (is_of_a_train(band.centre_Hz)) continue;
    frequencies_Hz.push_back(band.centre_Hz);
    const double damping = std::clamp(band.width_Hz / (4.0 * band.centre_Hz), 0.002, 0.3);
    TermFit solution =
        DropUnobservable(residual, residual.With(NarrowTerm(residual, index, band, damping), 12));
    KeepDamped(std::move(solution), range, best);
  }
  for (const BurstSpot& spot : FindBursts(residual, 2)) {
    if (spot.frequency_Hz > range.lowest_Hz && spot.frequency_Hz < range.highest_Hz &&
        !is_of_a_train(spot.frequency_Hz))
      frequencies_Hz.push_back(spot.frequency_Hz);
  }
  for (const double frequency_Hz :
       FindExcitedFrequencies(residual, range.lowest_Hz, range.highest_Hz, kMostExcited)) {
    const bool known = std::ranges::any_of(frequencies_Hz, [&](double other_Hz) {
      return std::abs(other_Hz - frequency_Hz) < kSameFrequency * frequency_Hz;
    });
    if (!known && !is_of_a_train(frequency_Hz)) frequencies_Hz.push_back(frequency_Hz);
  }
  for (const double frequency_Hz : frequencies_Hz) {
    if (Best struck = SearchTransients(residual, index, frequency_Hz))
      KeepDamped(std::move(*struck), range, best);
  }
  if (best &&
      (IsOfATrain(residual.base().terms, best->term.nonlinear_parameters[0], HalfWidthOf(best->term)) ||
       AreLines(residual, *best)))
    best.reset();
  if (range.by_shaft) TryDriven(residual, index, range, best);
  return best;
}

}  // namespace strainwave::analysis::diagnosis
