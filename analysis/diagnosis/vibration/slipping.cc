// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/slipping.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "analysis/diagnosis/vibration/bearing_orders.h"
#include "analysis/diagnosis/vibration/combs.h"
#include "analysis/diagnosis/vibration/impulse_chain.h"
#include "analysis/diagnosis/vibration/impulse_train_match.h"
#include "analysis/diagnosis/vibration/spectrum.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Best = std::optional<TermFit>;
using Complex = std::complex<double>;
using Series = std::vector<Complex>;

constexpr double kLowestResonance = 0.04;  // of the sampling rate
constexpr double kHighestSlipResonance = 0.45;
constexpr double kNextSlipResonance = 1.25;  // within a width of what rings
constexpr double kHousingDamping = 0.08;     // as a bearing's housing has it; what is found is refined
constexpr double kHarmonics = 4.0;           // of the highest order, in the spectrum of an envelope
constexpr double kClearExcess = 7.0;         // −ln p of a comb beyond all that were looked at
constexpr double kTrialsPerCell = 30.0;      // ranges of harmonics, and steps finer than a cell
constexpr std::size_t kMostTried = 3;
constexpr int kTracks = 3;
constexpr std::size_t kMostLinesThatBeat = 5;

constexpr double kLeastSlip = 1e-3;
constexpr double kLeastDecayOfEnvelope = 1.0;  // exponent, from one impulse to the next
constexpr double kHighest = 2.0;               // impulse, of the usual one: the load on the balls changes

// What a response that starts at a sample has in common with the residual behind it, each channel for itself.
std::vector<Series> Matched(const VibrationResidual& residual, double resonance_Hz, double damping) {
  const VibrationRun& run = residual.samples().runs.front();
  const Complex step = std::exp(ResonancePole(resonance_Hz, damping) * run.period_s);
  std::vector<Series> matched(run.channels.size(), Series(run.size()));
  MatchBackwards(residual.side_by_side(0), step,
                 [&](std::size_t first, std::size_t i, const InCommon& common) {
                   const std::size_t here = std::min(SideBySide::kTogether, matched.size() - first);
                   for (std::size_t c = 0; c < here; ++c)
                     matched[first + c][i] = {common[c], common[SideBySide::kTogether + c]};
                 });
  return matched;
}

// Energy of a response of height one, which is a sine that dies away.
double EnergyOf(const VibrationRun& run, double resonance_Hz, double damping) {
  return 0.5 / -std::expm1(-2.0 * damping * kTwoPi * resonance_Hz * run.period_s);
}

// Size of the response over turns, in as few samples as the highest order needs.
struct Envelope {
  VibrationSamples samples;
  std::vector<double> values;
};

Envelope EnvelopeOf(const VibrationRun& run, const std::vector<Series>& matched, double highest_order) {
  const double per_turn = 2.0 * kHarmonics * highest_order;
  const auto together = std::max<std::size_t>(
      1, static_cast<std::size_t>(static_cast<double>(run.size()) / (run.turns * per_turn)));
  Envelope envelope;
  VibrationRun& thin = envelope.samples.runs.emplace_back();
  for (std::size_t first = 0; first + together <= run.size(); first += together) {
    double square = 0.0;
    for (const Series& channel : matched) {
      for (std::size_t i = first; i < first + together; ++i) square += std::norm(channel[i]);
    }
    envelope.values.push_back(std::sqrt(square));
    thin.time_s.push_back(run.time_s[first] - run.time_s.front());
    thin.angle_rad.push_back(run.angle_rad[first] - run.angle_rad.front());
  }
  const double mean = std::reduce(envelope.values.begin(), envelope.values.end()) /
                      static_cast<double>(envelope.values.size());
  for (double& value : envelope.values) value -= mean;
  thin.channels.push_back({"envelope", 0, 1.0});
  thin.turns = thin.angle_rad.back() / kTwoPi;
  return envelope;
}

// An order, and the resonance that is observable with it.
struct ObservableTrain {
  double order{};
  double resonance_Hz{};
  double excess{};
};

std::vector<ObservableTrain> FindObservable(const VibrationResidual& residual, double lowest, double highest,
                                            const std::function<bool(double order)>& allowed) {
  const VibrationRun& run = residual.samples().runs.front();
  const double trials = std::log(kHighestSlipResonance / kLowestResonance) / std::log(kNextSlipResonance) *
                        kTrialsPerCell * (highest - lowest) * run.turns;
  std::vector<ObservableTrain> found;
  for (double resonance = kLowestResonance; resonance < kHighestSlipResonance;
       resonance *= kNextSlipResonance) {
    const double resonance_Hz = resonance / run.period_s;
    const Envelope envelope = EnvelopeOf(run, Matched(residual, resonance_Hz, kHousingDamping), highest);
    const std::vector<double> ones(envelope.values.size(), 1.0);
    const VibrationSpectrum spectrum(envelope.samples, envelope.values, ones, SpectrumAxis::kTurns);
    for (const Comb& comb :
         FindCombs(spectrum, lowest, std::min(highest, 0.45 * spectrum.highest()), 0.0, 1, allowed)) {
      if (comb.excess > std::log(trials) + kClearExcess)
        found.push_back({Refined(spectrum, comb).order, resonance_Hz, comb.excess});
    }
  }
  std::ranges::sort(found, std::greater<>(), &ObservableTrain::excess);
  found.resize(std::min(found.size(), kMostTried));
  return found;
}

// The channels as one: in the proportion in which they ring at these samples.
Series SlipInStep(const std::vector<Series>& matched, const std::vector<std::size_t>& at) {
  const auto energy_of = [&](const Series& channel) {
    double sum = 0.0;
    for (const std::size_t i : at) sum += std::norm(channel[i]);
    return sum;
  };
  const Series& largest = *std::ranges::max_element(matched, {}, energy_of);
  std::vector<double> gains;
  double square = 0.0;
  for (const Series& channel : matched) {
    double gain = 0.0;
    for (const std::size_t i : at) gain += (std::conj(largest[i]) * channel[i]).real();
    gains.push_back(gain);
    square += gain * gain;
  }
  Series together(largest.size());
  for (std::size_t c = 0; c < matched.size(); ++c) {
    const double gain = gains[c] / std::sqrt(std::max(square, 1e-300));
    for (std::size_t i = 0; i < together.size(); ++i) together[i] += gain * matched[c][i];
  }
  return together;
}

// Impulses of one sign, none much higher than the usual one, as the matched residual shows them.
// @param height  of the usual one
// @param sign  of the responses
VibrationTerm Tracked(const VibrationRun& run, const Series& together, double height, double variance,
                      double sign, VibrationTerm term) {
  const double energy = EnergyOf(run, term.nonlinear_parameters[1], term.nonlinear_parameters[2]);
  const double turn = kTwoPi * term.nonlinear_parameters[1] * run.period_s;  // of the resonance, in a sample
  const auto off_phase = [&](std::size_t i) { return std::arg(sign * together[i] * Complex{0.0, -1.0}); };
  std::vector<double> score;
  for (std::size_t i = 0; i < together.size(); ++i) {
    // Within half a sample the impulse may be where it is in step.
    const double out = std::max(0.0, std::abs(off_phase(i)) - 0.5 * turn);
    const double common = std::abs(together[i]) * std::cos(out);
    const double own = std::clamp(common / energy, 0.0, kHighest * height);
    score.push_back((own * common - 0.5 * own * own * energy) / variance);
  }
  std::vector<double> angles_rad;
  for (const std::size_t i : BestChain(run, term.nonlinear_parameters[0], score)) {
    const double later = std::clamp(off_phase(i) / turn, -0.5, 0.5);
    angles_rad.push_back(run.angle_rad[i] + later * run.period_s * run.speed_rad_per_s[i]);
  }
  if (!TakeImpulses(run, angles_rad, term)) term.slips.clear();
  return term;
}

// The impulses of a term, found anew with each better resonance.
Best Follow(const VibrationResidual& residual, VibrationTerm term) {
  const VibrationRun& run = residual.samples().runs.front();
  const double variance = residual.base().variance();
  Best best;
  for (int round = 0; round < kTracks; ++round) {
    const std::vector<Series> matched =
        Matched(residual, term.nonlinear_parameters[1], term.nonlinear_parameters[2]);
    const double energy = EnergyOf(run, term.nonlinear_parameters[1], term.nonlinear_parameters[2]);
    std::vector<double> score(run.size(), 0.0);
    for (const Series& channel : matched) {
      for (std::size_t i = 0; i < score.size(); ++i)
        score[i] += 0.5 * std::norm(channel[i]) / (energy * variance);
    }
    const std::vector<std::size_t> chain = BestChain(run, term.nonlinear_parameters[0], score);
    if (chain.size() < 8) return best;
    const Series together = SlipInStep(matched, chain);
    std::vector<double> heights;
    for (const std::size_t i : chain) heights.push_back(std::abs(together[i]) / energy);
    const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
    std::nth_element(heights.begin(), middle, heights.end());
    Best better;
    for (const double sign : {-1.0, 1.0}) {
      VibrationTerm tracked = Tracked(run, together, *middle, variance, sign, term);
      if (tracked.slips.empty()) continue;
      TermFit fit = residual.With(std::move(tracked), 4);
      if (!better || BicWithSlips(residual.samples(), fit) < BicWithSlips(residual.samples(), *better))
        better = std::move(fit);
    }
    if (!better ||
        (best && BicWithSlips(residual.samples(), *better) > BicWithSlips(residual.samples(), *best) - 1.0))
      break;
    best = std::move(better);
    term = best->term;
    term.observable.assign(term.observable.size(), 1);
  }
  return best;
}

// What still rings when the next impulse comes is no train of impulses to an envelope: to follow its phase is
// to follow any resonance that noise drives.
bool DiesAway(const VibrationResidual& residual, const VibrationTerm& train) {
  const VibrationRun& run = residual.samples().runs.front();
  const double apart_s = kTwoPi / (train.nonlinear_parameters[0] * run.mean_speed_rad_per_s);
  return train.nonlinear_parameters[2] * kTwoPi * train.nonlinear_parameters[1] * apart_s >
         kLeastDecayOfEnvelope;
}

VibrationTerm TermOf(const VibrationResidual& residual, std::size_t index,
                     const ObservableTrain& observable) {
  VibrationTerm term;
  term.cause = index;
  term.form = VibrationForm::kImpulseTrain;
  term.observable.assign(residual.samples().channels(), 1);
  term.nonlinear_parameters = {observable.order, observable.resonance_Hz, kHousingDamping, 0.0};
  return term;
}

// The same with impulses that change with the load on the balls.
Best WithChange(const VibrationResidual& residual, TermFit even) {
  Best best = even;
  for (const double order : {1.0, 2.0}) {
    VibrationTerm term = even.term;
    term.lines = {{0.0, order}};
    term.nonlinear_parameters.insert(term.nonlinear_parameters.begin() + 3, {0.0, 0.0});
    TermFit fit = residual.With(std::move(term), 6);
    if (fit.bic() < best->bic()) best = std::move(fit);
  }
  return best;
}

// Lines a few orders apart beat, so that together they are large so many times a turn: a few of them explain
// as much. What slips has no lines.
bool IsAFamilyOfLines(const VibrationResidual& residual, const TermFit& train, SpectrumAxis axis) {
  const bool over_turns = axis == SpectrumAxis::kTurns;
  const VibrationSpectrum& spectrum = over_turns ? residual.over_turns() : residual.over_seconds();
  const double turn_Hz = residual.samples().runs.front().mean_speed_rad_per_s / kTwoPi;
  const double unit_Hz = over_turns ? turn_Hz : 1.0;
  const double centre_Hz = train.term.nonlinear_parameters[1];
  const double reach_Hz = kResonanceReach * train.term.nonlinear_parameters[2] * centre_Hz +
                          train.term.nonlinear_parameters[0] * turn_Hz;
  VibrationTerm lines;
  lines.cause = train.term.cause;
  lines.form = over_turns ? VibrationForm::kLines : VibrationForm::kTones;
  lines.observable.assign(residual.samples().channels(), 1);
  for (const SpectrumPeak& peak :
       FindPeaks(spectrum, std::max(spectrum.cell(), (centre_Hz - reach_Hz) / unit_Hz),
                 (centre_Hz + reach_Hz) / unit_Hz, kMostLinesThatBeat)) {
    if (lines.nonlinear_parameters.empty()) lines.nonlinear_parameters = {peak.order};
    lines.lines.push_back({1.0, peak.order - lines.nonlinear_parameters[0]});
    if (residual.With(lines, 3).bic() < BicWithSlips(residual.samples(), train)) return true;
  }
  return false;
}

}  // namespace

double SlipShareOf(std::span<const double> slips) {
  double square = 0.0;
  double count = 0.0;
  for (std::size_t s = 1; s < slips.size(); ++s) {
    const double slip = slips[s] - slips[s - 1];
    square += slip * slip;
    count += slip != 0.0 ? 1.0 : 0.0;
  }
  return std::sqrt(square / std::max(1.0, count));
}

double OrderErrorOfSlips(const VibrationSamples& samples, const VibrationTerm& train) {
  if (train.slips.empty()) return 0.0;
  const double impulses = train.nonlinear_parameters[0] * samples.runs.front().turns;
  return SlipShareOf(train.slips) * train.nonlinear_parameters[0] / std::sqrt(std::max(1.0, impulses));
}

double LogSearchLocationsOfSlips(const VibrationSamples& samples, const VibrationTerm& train) {
  if (train.slips.empty()) return 0.0;
  const VibrationRun& run = samples.runs.front();
  const double harmonic =
      kTwoPi * train.nonlinear_parameters[1] / (train.nonlinear_parameters[0] * run.mean_speed_rad_per_s);
  // A normal spread is as wide as √(2πe) of its deviation.
  const double spread = std::sqrt(kTwoPi * std::numbers::e) * std::max(kLeastSlip, SlipShareOf(train.slips));
  return train.nonlinear_parameters[0] * run.turns * std::log1p(spread * 2.0 * harmonic);
}

double BicWithSlips(const VibrationSamples& samples, const TermFit& train) {
  return train.bic() + 2.0 * LogSearchLocationsOfSlips(samples, train.term);
}

Best SearchSlippingTrain(const VibrationResidual& residual, std::size_t index, double lowest, double highest,
                         const std::function<bool(double order)>& allowed) {
  Best best;
  if (residual.samples().runs.size() != 1) return best;
  for (const ObservableTrain& observable : FindObservable(residual, lowest, highest, allowed)) {
    Best fit = Follow(residual, TermOf(residual, index, observable));
    if (fit && DiesAway(residual, fit->term) &&
        (!best || BicWithSlips(residual.samples(), *fit) < BicWithSlips(residual.samples(), *best)))
      best = std::move(fit);
  }
  if (!best || IsAFamilyOfLines(residual, *best, SpectrumAxis::kTurns) ||
      IsAFamilyOfLines(residual, *best, SpectrumAxis::kSeconds))
    return std::nullopt;
  best = WithChange(residual, std::move(*best));
  Best again = Follow(residual, best->term);
  return again && BicWithSlips(residual.samples(), *again) < BicWithSlips(residual.samples(), *best) ? again
                                                                                                     : best;
}

}  // namespace strainwave::analysis::diagnosis
