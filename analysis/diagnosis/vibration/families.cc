// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/families.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "analysis/diagnosis/vibration/bearing_orders.h"
#include "analysis/diagnosis/vibration/chance.h"
#include "analysis/diagnosis/vibration/combs.h"
#include "analysis/diagnosis/vibration/impulses.h"
#include "analysis/diagnosis/vibration/line_sets.h"
#include "analysis/diagnosis/vibration/slipping.h"
#include "analysis/model/vibration_orders.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Best = std::optional<TermFit>;

constexpr int kMostLineHarmonics = 12;
constexpr int kTeethHarmonics = 3;
constexpr double kModulations[] = {0.0, 1.0, 2.0};
constexpr double kBesideStrongest = 14.0;  // of BIC
constexpr double kWholeOutputTurn = 0.8;   // from which on lines an output turn apart are told apart
constexpr int kPulseHarmonic = 2;          // from which on a record has to tell pulses from whole orders

TrainStart StartOf(const VibrationResidual& residual, const Comb& comb) {
  const double turn_Hz = residual.samples().runs.front().mean_speed_rad_per_s / kTwoPi;
  return {comb.order, comb.centre * comb.order * turn_Hz, comb.excess, 0.0, 1.0};
}

// Lines at a crack's order and its harmonics, which are those of tooth engagement, and beside them those of a
// change once or twice an output turn.
struct CrackLines {
  VibrationTerm term;
  std::vector<LineOrder> candidates;
  double order;
  int first;  // harmonic from which on the record tells it from whole orders
};

CrackLines CrackLinesOf(const VibrationResidual& residual, std::size_t index, int harmonics) {
  const VibrationSamples& samples = residual.samples();
  const double order = model::CrackOrder(samples.ratio);
  const double output = 1.0 / std::abs(samples.ratio);
  const double turns = samples.shortest_turns();
  CrackLines lines{.term = LinesTerm(residual, index),
                   .candidates = {},
                   .order = order,
                   .first = static_cast<int>(std::ceil(0.7 / (turns * (order - 2.0))))};
  // Where the shaft's lines leave the scale of the angle open, it is a number of the fit.
  const bool open = ScaleIsOpen(samples, order * harmonics);
  std::vector<double> orders;
  for (int k = std::max(1, lines.first); k <= harmonics && k * order < residual.over_turns().highest(); ++k) {
    orders.push_back(k * order);
    const LineOrder centre = open ? LineOrder{static_cast<double>(k), 0.0} : LineOrder{0.0, k * order};
    lines.candidates.push_back(centre);
    if (turns * output < kWholeOutputTurn) continue;
    for (const double sideband : {-output, output, -2.0 * output, 2.0 * output}) {
      // What falls onto a whole order is not the crack's own.
      const double beside = k * order + sideband;
      if (std::abs(beside - std::round(beside)) * turns > 0.7)
        lines.candidates.push_back({centre.harmonic, centre.offset + sideband});
    }
  }
  if (open) lines.term.nonlinear_parameters = {orders.empty() ? order : order * BestScale(residual, orders)};
  return lines;
}

constexpr double kTeethSideband = 2.0;       // orders
constexpr double kResonancesOfCrack = 45.0;  // resonances a width apart

constexpr double kHighestResonance =
    0.48;  // of the sampling rate; a fit leaves what was searched for a start

// Mean of xⁿ where ln x is even between two limits.
double MeanOfPower(double n, double low, double high) {
  return (std::pow(high, n) - std::pow(low, n)) / (n * std::log(high / low));
}

// Of a known order; what is none of its multiples is a sideband.
double HarmonicOf(const LineOrder& line, double order) { return line.harmonic + line.offset / order; }
bool IsWhole(double harmonic) { return std::abs(harmonic - std::round(harmonic)) < 1e-9; }

// One line alone that is not the order itself may be anything that happens to be there: of whole orders a
// short record tells high multiples only.
bool IsALineBeside(const std::vector<LineOrder>& lines, double order) {
  return lines.size() == 1 && std::abs(HarmonicOf(lines[0], order) - 1.0) > 1e-9;
}

// The shaft's line at 2 per turn, changed by a point that comes by once per output turn: a line to either
// side of it, and nothing at the crack's own order. Both have to be there: the lower one of the teeth's
// sidebands is the upper one of these.
constexpr double kLeastOfWeaker = 0.15;  // of the power of the stronger
constexpr double kLobes = 2.0;
Best SidebandsOfShaft(const VibrationResidual& residual, std::size_t index) {
  const double output = 1.0 / std::abs(residual.samples().ratio);
  const double lower = PowerAt(residual, kLobes - output);
  const double upper = PowerAt(residual, kLobes + output);
  if (std::min(lower, upper) < kLeastOfWeaker * std::max(lower, upper)) return std::nullopt;
  VibrationTerm term = LinesTerm(residual, index);
  term.lines = {{0.0, kLobes - output}, {0.0, kLobes + output}};
  return residual.WithAllChannels(std::move(term), 0);
}

// A pulse of a tenth of a turn has a third harmonic of a quarter of the first: nobody overlooks it here.
constexpr double kStrong = 400.0;      // gain in BIC of the harmonics themselves
constexpr double kMostOfThird = 0.04;  // of the power of the first, that teeth have, too
bool IsStrongAndSmooth(const TermFit& fit, double order) {
  const std::vector<double> gains = LineGains(fit);
  std::array<double, kTeethHarmonics> of_harmonics{};
  for (std::size_t l = 0; l < gains.size(); ++l) {
    const LineOrder& line = fit.term.lines[l];
    const double harmonic = HarmonicOf(line, order);
    if (harmonic > kTeethHarmonics + 0.5) return false;
    if (IsWhole(harmonic)) of_harmonics[static_cast<std::size_t>(std::lround(harmonic)) - 1] += gains[l];
  }
  return of_harmonics[2] <= kMostOfThird * of_harmonics[0] &&
         std::accumulate(of_harmonics.begin(), of_harmonics.end(), 0.0) > kStrong;
}

// The same where the first two harmonics happen to be in step, as if they were a pulse's.
bool IsStrongAndWide(const VibrationResidual& residual, const TermFit& pulses) {
  constexpr double kWide = 0.12;  // third harmonic of a tenth of the first
  const double width = WidthIsNonlinearParameter(pulses.term) ? pulses.term.nonlinear_parameters[0]
                                                              : pulses.term.lines[0].harmonic;
  return width > kWide && residual.base().bic() - pulses.bic() > kStrong;
}

// The order itself, or two of its harmonics, have to be there.
bool AreAFamily(std::span<const LineOrder> lines) {
  const auto is_centre = [](const LineOrder& line) { return line.offset == 0.0; };
  const auto is_first = [](const LineOrder& line) { return line.offset == 0.0 && line.harmonic == 1.0; };
  return std::ranges::count_if(lines, is_centre) >= 2 ||
         (std::ranges::any_of(lines, is_first) && lines.size() >= 3);
}

// Teeth make the same lines, with the shaft's sidebands, and need no resonance for it.
bool ResonatesAmongTeeth(const VibrationSamples& samples, const VibrationTerm& train) {
  const double turn_Hz = samples.runs.front().mean_speed_rad_per_s / kTwoPi;
  const double centre = train.nonlinear_parameters[1] / turn_Hz;
  const double flexspline = model::FlexsplineMeshOrder(samples.ratio);
  const double circular = model::CircularSplineMeshOrder(samples.ratio);
  const double multiple = std::max(1.0, std::round(2.0 * centre / (flexspline + circular)));
  return centre > multiple * flexspline - kTeethSideband && centre < multiple * circular + kTeethSideband;
}

// Orders that a bearing may have.
struct BearingRange {
  const VibrationResidual& residual;
  double end;  // of the spectrum
  double lowest{kLowestBearingOrder};
  double highest;

  explicit BearingRange(const VibrationResidual& own)
      : residual(own), end(own.over_turns().highest()), highest(std::min(kHighestBearingOrder, 0.45 * end)) {}

  // While searching all harmonics that there may be decide, afterwards those that the fit rests on.
  bool Allows(double order) const { return IsBearingOrder(residual, order, end / order); }
};

// The strongest first.
std::vector<Comb> CombsOf(const VibrationResidual& residual, const BearingRange& range) {
  const VibrationSpectrum& spectrum = residual.over_turns();
  const auto allowed = [&](double order) { return range.Allows(order); };
  std::vector<Comb> combs;
  for (const double sideband : kModulations) {
    for (const Comb& comb : FindCombs(spectrum, range.lowest, range.highest, sideband, 3, allowed))
      combs.push_back(Refined(spectrum, comb));
  }
  std::sort(combs.begin(), combs.end(), [](const Comb& a, const Comb& b) { return a.excess > b.excess; });
  return combs;
}

Best ImpulsesOfBearing(const VibrationResidual& residual, std::size_t index, const BearingRange& range,
                       std::span<const Comb> combs) {
  const auto allowed = [&](double order) { return range.Allows(order); };
  std::vector<TrainStart> starts;
  for (std::size_t c = 0; c < std::min<std::size_t>(4, combs.size()); ++c)
    starts.push_back(StartOf(residual, combs[c]));
  const auto trains = FindTrains(residual, range.lowest, range.highest, kModulations, 20, allowed);
  starts.insert(starts.end(), trains.begin(), trains.end());
  Best best = SearchImpulses(residual, index, starts, {1.0, 2.0}, [&](double order) {
    return order > range.lowest && order < range.highest && allowed(order);
  });
  if (best && !IsBearing(residual, best->term)) best.reset();
  return best;
}

// A few low harmonics need no search of their own: the strongest lines say where they may be. Of a slow
// logger the first one with its sidebands may be all there is.
Best LinesOfBearing(const VibrationResidual& residual, std::size_t index, const BearingRange& range,
                    std::span<const Comb> combs) {
  const VibrationSpectrum& spectrum = residual.over_turns();
  std::vector<double> bases;
  for (std::size_t c = 0; c < std::min<std::size_t>(3, combs.size()); ++c) bases.push_back(combs[c].order);
  const double highest_first = std::min(kHighestBearingOrder, spectrum.highest() - 1.0);
  for (const SpectrumPeak& peak : FindPeaks(spectrum, range.lowest, spectrum.highest(), 3)) {
    for (int k = 1; k <= 3; ++k) {
      const double base = peak.order / k;
      if (base > range.lowest && base < highest_first && range.Allows(base)) bases.push_back(base);
    }
  }
  Best best;
  for (const double base : bases) {
    VibrationTerm term = LinesTerm(residual, index);
    term.nonlinear_parameters = {base};
    std::vector<LineOrder> candidates;
    for (int k = 1; k <= kMostLineHarmonics && k * base < spectrum.highest(); ++k) {
      for (const double offset : {0.0, -1.0, 1.0, -2.0, 2.0}) {
        candidates.push_back({static_cast<double>(k), offset});
      }
    }
    Best lines = FitPayingLines(residual, std::move(term), candidates, 2, AreAFamily);
    if (!lines) continue;
    // What is beside the strongest line has to stand for itself: there were many candidates.
    std::vector<double> gains = LineGains(*lines);
    std::sort(gains.begin(), gains.end());
    const double beside = std::accumulate(gains.begin(), gains.end() - 1, 0.0);
    if (beside > kBesideStrongest && IsBearing(residual, lines->term)) Keep(std::move(*lines), best);
  }
  return best;
}

Best SlippingBearing(const VibrationResidual& residual, std::size_t index, const BearingRange& range) {
  Best slipping = SearchSlippingTrain(residual, index, range.lowest, range.highest, [&](double order) {
    return IsBearingOrder(residual, order, kHarmonicsOfSlipping);
  });
  if (slipping && !IsBearing(residual, slipping->term)) slipping.reset();
  return slipping;
}

}  // namespace

double LogSearchLocationsOfCrack(const VibrationSamples& samples, const VibrationTerm& crack) {
  if (crack.form != VibrationForm::kImpulseTrain) return 0.0;
  const double turn_Hz = samples.runs.front().mean_speed_rad_per_s / kTwoPi;
  const double harmonic =
      std::max(1.0, crack.nonlinear_parameters[1] / (crack.nonlinear_parameters[0] * turn_Hz));
  return std::log(kResonancesOfCrack * 2.0 * harmonic);
}

double LogSearchLocationsOfTrain(const VibrationSamples& samples, const VibrationTerm& train) {
  if (train.form != VibrationForm::kImpulseTrain || !train.slips.empty()) return 0.0;
  // A cell in order and one in time are as wide as a period of the resonance, 1 / f, one in ln f or in ln ζ
  // as the resonance's width, ζ: there are f² / order² of the former and 1 / ζ of the latter (the square root
  // of the determinant of Fisher's information).
  const double resonance = train.nonlinear_parameters[1] * samples.runs.front().period_s;
  const double order = train.nonlinear_parameters[0];
  const double damping = std::clamp(train.nonlinear_parameters[2], kLeastTrainDamping, kMostTrainDamping);
  const double mean_of_orders = 1.0 / (kLowestBearingOrder * kHighestBearingOrder);
  return std::log(resonance * resonance / MeanOfPower(2.0, kLowestTrainResonance, kHighestResonance)) -
         std::log(order * order * mean_of_orders) -
         std::log(damping * MeanOfPower(-1.0, kLeastTrainDamping, kMostTrainDamping));
}

Best SearchBearing(const VibrationResidual& residual, std::size_t index) {
  const BearingRange range(residual);
  const std::vector<Comb> combs = CombsOf(residual, range);
  std::array<Best, 3> found;
  residual.parallel()(found.size(), [&](std::size_t way) {
    if (way == 0) found[0] = ImpulsesOfBearing(residual, index, range, combs);
    if (way == 1) found[1] = SlippingBearing(residual, index, range);
    if (way == 2) found[2] = LinesOfBearing(residual, index, range, combs);
  });
  auto& [impulses, slipping, lines] = found;
  Best best = std::move(impulses);
  if (lines) Keep(std::move(*lines), best);
  if (slipping && (!best || BicWithSlips(residual.samples(), *slipping) < best->bic()))
    best = std::move(slipping);
  return best;
}

Best SearchToothEngagement(const VibrationResidual& residual, std::size_t index) {
  CrackLines lines = CrackLinesOf(residual, index, kTeethHarmonics);
  Best best = FitPayingLines(residual, std::move(lines.term), std::move(lines.candidates), 1);
  // A line beside an order that is not there belongs to something else: the shaft's own lines that change
  // once per output turn have one where the lower sideband of the teeth's would be.
  if (best && std::ranges::none_of(best->term.lines, [&](const LineOrder& line) {
        return IsWhole(HarmonicOf(line, lines.order));
      }))
    best.reset();
  return best;
}

Best SearchCrack(const VibrationResidual& residual, std::size_t index) {
  const VibrationSamples& samples = residual.samples();
  const VibrationSpectrum& spectrum = residual.over_turns();
  const double output = 1.0 / std::abs(samples.ratio);
  const double turns = samples.shortest_turns();
  CrackLines lines = CrackLinesOf(residual, index, kMostLineHarmonics);
  const double order = lines.order;
  LeastLikelyChance best(residual);
  if (Best of_lines = FitPayingLines(residual, std::move(lines.term), lines.candidates, 1);
      of_lines && !IsStrongAndSmooth(*of_lines, order) && !IsALineBeside(of_lines->term.lines, order)) {
    const double log_choices = LogChoices(of_lines->term.lines.size(), lines.candidates.size());
    best.Take(std::move(*of_lines), log_choices);
  }
  const double range = kScaleRange * samples.order_uncertainty * order + 0.5 * spectrum.cell() / 100.0;
  std::vector<TrainStart> starts;
  for (const double sideband : {0.0, output}) {
    const Comb comb = Refined(spectrum, CombNear(spectrum, order, range, sideband));
    if (comb.excess > 6.0 && comb.last >= lines.first) starts.push_back(StartOf(residual, comb));
    if (turns * output < kWholeOutputTurn) break;
  }
  std::vector<double> modulations;
  if (turns * output > 0.5) modulations = {output};
  if (lines.first <= kPulseHarmonic) {
    TermFit pulses = SearchPulses(residual, index, order, turns * output > 0.5 ? output : 0.0);
    if (!IsStrongAndWide(residual, pulses)) best.Take(std::move(pulses), 0.0);
  }
  if (Best impulses = SearchImpulses(residual, index, starts, modulations, [](double) { return false; });
      impulses && !ResonatesAmongTeeth(samples, impulses->term)) {
    const double log_search_locations = LogSearchLocationsOfCrack(samples, impulses->term);
    best.Take(std::move(*impulses), log_search_locations);
  }
  if (turns * output > kWholeOutputTurn) {
    if (Best sidebands = SidebandsOfShaft(residual, index))
      best.TakeWithAndWithoutUnobservable(std::move(*sidebands), 0.0);
  }
  return std::move(best).fit();
}

}  // namespace strainwave::analysis::diagnosis
