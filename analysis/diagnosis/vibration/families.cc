// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/families.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <utility>

#include "analysis/diagnosis/vibration/bearing_orders.h"
#include "analysis/diagnosis/vibration/combs.h"
#include "analysis/diagnosis/vibration/impulses.h"
#include "analysis/model/vibration_orders.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Best = std::optional<TermFit>;

constexpr int kMostLineHarmonics = 12;
constexpr std::size_t kMostLines = 10;
constexpr double kLeastOfSet = 4.0;  // −ln p of known lines together
constexpr double kModulations[] = {0.0, 1.0, 2.0};
constexpr double kBesideStrongest = 14.0;  // of BIC
constexpr double kMostScales = 500.0;      // of known orders, to either side
constexpr int kPulseHarmonic = 2;          // from which on a record has to tell pulses from whole orders

VibrationTerm LinesTerm(const VibrationRemainder& remainder, std::size_t index) {
  VibrationTerm term;
  term.cause = index;
  term.form = VibrationForm::kLines;
  term.heard.assign(remainder.samples().channels(), 1);
  return term;
}

// Power of a line beyond half the sampling rate: no spectrum has it, but its samples are there, folded.
double FoldedPower(const VibrationRemainder& remainder, double order) {
  const double variance = remainder.base().variance();
  double sum = 0.0;
  for (const VibrationRun& run : remainder.samples().runs) {
    std::vector<std::complex<double>> line(run.size());
    for (std::size_t i = 0; i < run.size(); ++i) line[i] = std::polar(1.0, order * run.angle_rad[i]);
    for (const VibrationStretch& channel : run.channels) {
      std::complex<double> product;
      for (std::size_t i = 0; i < run.size(); ++i) {
        if (remainder.solver().weights()[channel.first + i] > 0.0)
          product += remainder.residual()[channel.first + i] * line[i];
      }
      sum += std::norm(product) / (variance * static_cast<double>(run.size()));
    }
  }
  return sum;
}

double PowerAt(const VibrationRemainder& remainder, double order) {
  const bool folded = order > 0.98 * remainder.samples().highest_order();
  return folded ? FoldedPower(remainder, order) : remainder.over_turns().At(order);
}

double ExcessAt(const VibrationRemainder& remainder, double order) {
  return ExcessOf(PowerAt(remainder, order), static_cast<double>(remainder.over_turns().channels()));
}

// Drop that each line of a term brings, of all channels, over what its coefficients cost there.
std::vector<double> LineGains(const TermFit& fit) {
  std::vector<double> gains(fit.term.lines.size(), 0.0);
  for (const TermFit::Channel& channel : fit.channels) {
    if (channel.coefficients.size() == 0) continue;
    for (std::size_t l = 0; l < gains.size(); ++l) {
      const auto at = static_cast<Eigen::Index>(2 * l);
      const Eigen::Vector2d own = channel.coefficients.segment(at, 2);
      const Eigen::MatrixXd block = channel.inverse.block(at, at, 2, 2);
      gains[l] += own.dot(PseudoInverse(block) * own) / fit.variance() - 2.0 * std::log(fit.weight_sum);
    }
  }
  return gains;
}

// Fits the lines that stand out in the spectrum, then drops those that do not pay.
Best FitPayingLines(const VibrationRemainder& remainder, VibrationTerm term, std::vector<LinePlace> places,
                    std::size_t fewest) {
  const double base = term.shapes.empty() ? 1.0 : term.shapes[0];
  const double threshold = 0.8 * std::log(remainder.base().weight_sum);
  std::vector<std::pair<double, LinePlace>> found;
  for (const LinePlace& place : places) {
    const double order = place.harmonic * base + place.offset;
    const double excess = ExcessAt(remainder, order);
    const bool taken = std::any_of(found.begin(), found.end(), [&](const auto& other) {
      return std::abs(other.second.harmonic * base + other.second.offset - order) <
             0.3 * remainder.over_turns().cell();
    });
    if (excess > threshold && !taken) found.emplace_back(excess, place);
  }
  if (found.size() < fewest) return std::nullopt;
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  found.resize(std::min(found.size(), kMostLines));
  for (const auto& [excess, place] : found) term.lines.push_back(place);
  TermFit solution = remainder.With(term, term.shapes.empty() ? 0 : 5);
  while (solution.term.lines.size() >= fewest) {
    const std::vector<double> gains = LineGains(solution);
    const auto worst = std::min_element(gains.begin(), gains.end());
    if (*worst > 0.0) return solution;
    VibrationTerm fewer = solution.term;
    fewer.lines.erase(fewer.lines.begin() + (worst - gains.begin()));
    if (fewer.lines.size() < fewest) break;
    solution = remainder.With(std::move(fewer), 0);
  }
  return std::nullopt;
}

// Scale of known orders that agrees best with the spectrum, where the shaft's own lines leave it open.
double BestScale(const VibrationRemainder& remainder, const std::vector<double>& orders) {
  const double highest = *std::max_element(orders.begin(), orders.end());
  const double step = 0.25 * remainder.over_turns().cell() / highest;
  const double range = std::min(kScaleRange * remainder.samples().order_uncertainty, kMostScales * step);
  double best = 1.0;
  double most = -1.0;
  for (double change = 0.0; change <= range; change += step) {
    for (const double scale : {1.0 - change, 1.0 + change}) {
      double sum = 0.0;
      for (const double order : orders) sum += ExcessAt(remainder, scale * order);
      // A scale of its own has to pay for itself.
      if (change > 0.0) sum -= 8.0;
      if (sum > most) {
        most = sum;
        best = scale;
      }
    }
  }
  return best;
}

// Those of the orders that are together least likely to be noise: either or both of the first two, and the
// strongest of the others, each for the choice that there is. Nothing where noise does as well.
std::vector<double> LikeliestSet(const VibrationRemainder& remainder, const std::vector<double>& first_two,
                                 const std::vector<double>& orders, double scale) {
  const auto channels = static_cast<double>(remainder.over_turns().channels());
  const double apart = 0.3 * remainder.over_turns().cell();
  std::vector<std::pair<double, double>> others;  // power, order
  std::vector<double> places(first_two);
  for (const double order : orders) {
    if (std::ranges::any_of(places, [&](double other) { return std::abs(other - order) * scale < apart; }))
      continue;
    places.push_back(order);
    others.emplace_back(PowerAt(remainder, scale * order), order);
  }
  std::ranges::sort(others, std::greater<>());
  const double powers[] = {PowerAt(remainder, scale * first_two[0]),
                           PowerAt(remainder, scale * first_two[1])};
  double most = kLeastOfSet;
  std::vector<double> best;
  for (const unsigned mask : {1U, 2U, 3U}) {
    std::vector<double> chosen;
    double sum = 0.0;
    for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
      if ((mask >> k & 1U) == 0) continue;
      chosen.push_back(first_two[k]);
      sum += powers[k];
    }
    double choice = 0.0;
    for (std::size_t more = 0;; ++more) {
      const double excess = ExcessOf(sum, channels * static_cast<double>(chosen.size())) - choice;
      if (excess > most) {
        most = excess;
        best = chosen;
      }
      if (more == others.size() || chosen.size() == kMostLines) break;
      sum += others[more].first;
      chosen.push_back(others[more].second);
      choice += std::log(static_cast<double>(others.size() - more) / static_cast<double>(more + 1));
    }
  }
  return best;
}

bool ScaleIsOpen(const VibrationRemainder& remainder, double order) {
  return kScaleRange * remainder.samples().order_uncertainty * order > 0.25 * remainder.over_turns().cell();
}

TrainStart StartOf(const VibrationRemainder& remainder, const Comb& comb) {
  const double turn_Hz = remainder.samples().runs.front().mean_speed_rad_per_s / kTwoPi;
  return {comb.order, comb.centre * comb.order * turn_Hz, comb.excess, 0.0, 1.0};
}

// Lines at a crack's order and its harmonics, which are those of tooth engagement, and beside them those of a
// change once or twice an output turn.
struct CrackLines {
  VibrationTerm term;
  std::vector<LinePlace> places;
  double order;
  int first;  // harmonic from which on the record tells it from whole orders
};

CrackLines CrackLinesOf(const VibrationRemainder& remainder, std::size_t index, int harmonics) {
  const VibrationSamples& samples = remainder.samples();
  const double order = model::CrackOrder(samples.ratio);
  const double output = 1.0 / std::abs(samples.ratio);
  const double turns = samples.shortest_turns();
  CrackLines lines{.term = LinesTerm(remainder, index),
                   .places = {},
                   .order = order,
                   .first = static_cast<int>(std::ceil(0.7 / (turns * (order - 2.0))))};
  // Where the shaft's lines leave the scale of the angle open, it is a number of the fit.
  const bool open = ScaleIsOpen(remainder, order * harmonics);
  std::vector<double> orders;
  for (int k = std::max(1, lines.first); k <= harmonics && k * order < remainder.over_turns().highest();
       ++k) {
    orders.push_back(k * order);
    const LinePlace centre = open ? LinePlace{static_cast<double>(k), 0.0} : LinePlace{0.0, k * order};
    lines.places.push_back(centre);
    if (turns * output < 0.8) continue;
    for (const double sideband : {-output, output, -2.0 * output, 2.0 * output}) {
      // What falls onto a whole order is not the crack's own.
      const double beside = k * order + sideband;
      if (std::abs(beside - std::round(beside)) * turns > 0.7)
        lines.places.push_back({centre.harmonic, centre.offset + sideband});
    }
  }
  if (open) lines.term.shapes = {orders.empty() ? order : order * BestScale(remainder, orders)};
  return lines;
}

// A pulse of a tenth of a turn has a third harmonic of a quarter of the first: nobody overlooks it here.
constexpr double kLoud = 400.0;  // gain in BIC of the harmonics themselves
bool IsLoudAndSmooth(const TermFit& fit, double order) {
  const std::vector<double> gains = LineGains(fit);
  double loudness = 0.0;
  for (std::size_t l = 0; l < gains.size(); ++l) {
    const LinePlace& line = fit.term.lines[l];
    const double harmonic = line.harmonic + line.offset / order;
    if (harmonic > 2.5) return false;
    if (std::abs(harmonic - std::round(harmonic)) < 1e-9) loudness += gains[l];
  }
  return loudness > kLoud;
}

// The same where the first two harmonics happen to be in step, as if they were a pulse's.
bool IsLoudAndWide(const VibrationRemainder& remainder, const TermFit& pulses) {
  constexpr double kWide = 0.12;  // third harmonic of a tenth of the first
  const double width = WidthIsShape(pulses.term) ? pulses.term.shapes[0] : pulses.term.lines[0].harmonic;
  return width > kWide && remainder.base().bic() - pulses.bic() > kLoud;
}

}  // namespace

Best SearchGearMesh(const VibrationRemainder& remainder, std::size_t index) {
  const VibrationSamples& samples = remainder.samples();
  const double flexspline = model::FlexsplineMeshOrder(samples.ratio);
  const double circular = model::CircularSplineMeshOrder(samples.ratio);
  const double highest = samples.highest_order();
  const double output = 1.0 / std::abs(samples.ratio);
  std::vector<double> orders;
  for (int multiple = 1; multiple <= 3; ++multiple) {
    if (multiple > 1 && multiple * circular > highest) break;
    for (const double centre : {multiple * flexspline, multiple * circular}) {
      orders.push_back(centre);
      for (const double sideband : {-2.0, -1.0, 1.0, 2.0}) orders.push_back(centre + sideband);
      if (samples.shortest_turns() * output < 0.5) continue;
      for (const double sideband : {-output, output}) orders.push_back(centre + sideband);
    }
  }
  // Where the shaft's lines leave the scale of the angle open, it is a number of the fit.
  Best best;
  for (const bool open : {false, true}) {
    if (open && !ScaleIsOpen(remainder, flexspline)) break;
    VibrationTerm term = LinesTerm(remainder, index);
    if (open) term.shapes = {BestScale(remainder, {flexspline, circular})};
    const auto place = [&](double order) { return open ? LinePlace{order, 0.0} : LinePlace{0.0, order}; };
    std::vector<LinePlace> places;
    std::ranges::transform(orders, std::back_inserter(places), place);
    // Lines that stand out each for itself; or a few weak ones that do together.
    if (Best own = FitPayingLines(remainder, term, std::move(places), 1)) Keep(std::move(*own), best);
    const double scale = open ? term.shapes[0] : 1.0;
    std::ranges::transform(LikeliestSet(remainder, {flexspline, circular}, orders, scale),
                           std::back_inserter(term.lines), place);
    if (!term.lines.empty()) Keep(remainder.With(std::move(term), open ? 5 : 0), best);
  }
  if (!best) return best;
  // A mesh without either of its own orders is none.
  const auto is_centre = [&](const LinePlace& line) {
    const double order = line.harmonic + line.offset;
    const double by_flexspline = order / flexspline;
    const double by_circular = order / circular;
    return std::abs(by_flexspline - std::round(by_flexspline)) < 1e-9 ||
           std::abs(by_circular - std::round(by_circular)) < 1e-9;
  };
  if (!std::ranges::any_of(best->term.lines, is_centre)) return std::nullopt;
  return best;
}

Best SearchBearing(const VibrationRemainder& remainder, std::size_t index) {
  const VibrationSpectrum& spectrum = remainder.over_turns();
  // While searching all harmonics that there may be decide, afterwards those that the fit rests on.
  const auto allowed = [&](double order) {
    return IsBearingOrder(remainder, order, spectrum.highest() / order);
  };
  const double lowest = kLowestBearingOrder;
  const double highest = std::min(kHighestBearingOrder, 0.45 * spectrum.highest());
  std::vector<Comb> combs;
  for (const double sideband : {0.0, 1.0, 2.0}) {
    for (const Comb& comb : FindCombs(spectrum, lowest, highest, sideband, 3, allowed)) {
      combs.push_back(Refined(spectrum, comb));
    }
  }
  std::sort(combs.begin(), combs.end(), [](const Comb& a, const Comb& b) { return a.excess > b.excess; });
  std::vector<TrainStart> starts;
  for (std::size_t c = 0; c < std::min<std::size_t>(4, combs.size()); ++c)
    starts.push_back(StartOf(remainder, combs[c]));
  const auto trains = FindTrains(remainder, lowest, highest, kModulations, 20, allowed);
  starts.insert(starts.end(), trains.begin(), trains.end());
  Best best = SearchImpulses(remainder, index, starts, {1.0, 2.0}, [&](double order) {
    return order > lowest && order < highest && allowed(order);
  });
  if (best && !IsBearing(remainder, best->term)) best.reset();
  std::vector<double> bases;
  for (std::size_t c = 0; c < std::min<std::size_t>(3, combs.size()); ++c) bases.push_back(combs[c].order);
  // A few low harmonics need no search of their own: the strongest lines say where they may be.
  for (const SpectrumPeak& peak : FindPeaks(spectrum, lowest, spectrum.highest(), 3)) {
    for (int k = 1; k <= 3; ++k) {
      const double base = peak.order / k;
      if (base > lowest && base < highest && allowed(base)) bases.push_back(base);
    }
  }
  for (const double base : bases) {
    VibrationTerm term = LinesTerm(remainder, index);
    term.shapes = {base};
    std::vector<LinePlace> places;
    for (int k = 1; k <= kMostLineHarmonics && k * base < spectrum.highest(); ++k) {
      for (const double offset : {0.0, -1.0, 1.0, -2.0, 2.0}) {
        places.push_back({static_cast<double>(k), offset});
      }
    }
    Best lines = FitPayingLines(remainder, std::move(term), std::move(places), 2);
    if (!lines) continue;
    // The order itself, or two of its harmonics, have to be there; and what is beside the strongest line has
    // to stand for itself: many places were looked at.
    const auto& kept = lines->term.lines;
    const auto is_centre = [](const LinePlace& line) { return line.offset == 0.0; };
    const auto is_first = [](const LinePlace& line) { return line.offset == 0.0 && line.harmonic == 1.0; };
    const bool family = std::ranges::count_if(kept, is_centre) >= 2 ||
                        (std::ranges::any_of(kept, is_first) && kept.size() >= 3);
    std::vector<double> gains = LineGains(*lines);
    std::sort(gains.begin(), gains.end());
    const double beside = std::accumulate(gains.begin(), gains.end() - 1, 0.0);
    if (family && beside > kBesideStrongest && IsBearing(remainder, lines->term))
      Keep(std::move(*lines), best);
  }
  return best;
}

Best SearchToothEngagement(const VibrationRemainder& remainder, std::size_t index) {
  CrackLines lines = CrackLinesOf(remainder, index, 2);
  return FitPayingLines(remainder, std::move(lines.term), std::move(lines.places), 1);
}

Best SearchCrack(const VibrationRemainder& remainder, std::size_t index) {
  const VibrationSamples& samples = remainder.samples();
  const VibrationSpectrum& spectrum = remainder.over_turns();
  const double output = 1.0 / std::abs(samples.ratio);
  const double turns = samples.shortest_turns();
  CrackLines lines = CrackLinesOf(remainder, index, kMostLineHarmonics);
  const double order = lines.order;
  Best best = FitPayingLines(remainder, std::move(lines.term), std::move(lines.places), 1);
  if (best && IsLoudAndSmooth(*best, order)) best.reset();
  const double range = kScaleRange * samples.order_uncertainty * order + 0.5 * spectrum.cell() / 100.0;
  std::vector<TrainStart> starts;
  for (const double sideband : {0.0, output}) {
    const Comb comb = Refined(spectrum, CombNear(spectrum, order, range, sideband));
    if (comb.excess > 6.0 && comb.last >= lines.first) starts.push_back(StartOf(remainder, comb));
    if (turns * output < 0.8) break;
  }
  std::vector<double> modulations;
  if (turns * output > 0.5) modulations = {output};
  if (lines.first <= kPulseHarmonic) {
    TermFit pulses = SearchPulses(remainder, index, order, turns * output > 0.5 ? output : 0.0);
    if (!IsLoudAndWide(remainder, pulses)) Keep(std::move(pulses), best);
  }
  if (Best rings = SearchImpulses(remainder, index, starts, modulations, [](double) { return false; })) {
    Keep(std::move(*rings), best);
  }
  return best;
}

}  // namespace strainwave::analysis::diagnosis
