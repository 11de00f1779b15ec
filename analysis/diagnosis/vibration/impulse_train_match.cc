// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/impulse_train_match.h"

#include <algorithm>
#include <cmath>

#include "analysis/units.h"
#include "analysis/vector_clones.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Complex = std::complex<double>;

constexpr double kBinsPerDecay = 4.0;
constexpr double kLeastOverlap = 0.05;

using Few = double __attribute__((vector_size(32), aligned(8), may_alias));
static_assert(sizeof(Few) == sizeof(double[SideBySide::kTogether]));

// What a response that starts at each sample has in common with a residual: squares, summed over the
// channels, or where their gains are known the common amplitude.
std::vector<double> MatchRinging(const SideBySide& residual, Complex step, std::span<const double> gains) {
  std::vector<double> matched(residual.run().size(), 0.0);
  if (gains.empty()) {
    MatchBackwards(residual, step, [&](std::size_t, std::size_t i, const InCommon& common) {
      for (std::size_t c = SideBySide::kTogether; c < common.size(); ++c) matched[i] += common[c] * common[c];
    });
  } else {
    const std::size_t channels = residual.run().channels.size();
    MatchBackwards(residual, step, [&](std::size_t first, std::size_t i, const InCommon& common) {
      const std::size_t here = std::min(SideBySide::kTogether, channels - first);
      for (std::size_t c = 0; c < here; ++c)
        matched[i] += gains[first + c] * common[SideBySide::kTogether + c];
    });
  }
  return matched;
}

// A response's sine has half of the energy 1 / (1 − |step|²).
double RingingEnergy(Complex step) { return 0.5 / (1.0 - std::norm(step)); }

}  // namespace

SideBySide::SideBySide(const VibrationRun& run, std::span<const double> residual,
                       std::span<const double> weights)
    : run_(run), values_((run.channels.size() + kTogether - 1) / kTogether * kTogether * run.size(), 0.0) {
  for (std::size_t c = 0; c < run.channels.size(); ++c) {
    double* const own = values_.data() + c / kTogether * kTogether * run.size() + c % kTogether;
    const std::size_t first = run.channels[c].first;
    for (std::size_t i = 0; i < run.size(); ++i)
      own[i * kTogether] = weights[first + i] > 0.0 ? residual[first + i] : 0.0;
  }
}

STRAINWAVE_VECTOR_CLONES
void FilterBackwards(const double* values, std::size_t samples, Complex step, InCommon& state,
                     InCommon* common) {
  auto* const ends = reinterpret_cast<Few*>(state.data());
  Few real = ends[0];
  Few imaginary = ends[1];
  for (std::size_t i = samples; i-- > 0;) {
    const Few value = *reinterpret_cast<const Few*>(values + i * SideBySide::kTogether);
    const Few turned = real * step.imag() + imaginary * step.real();
    real = (value - imaginary * step.imag()) + real * step.real();
    imaginary = turned;
    auto* const here = reinterpret_cast<Few*>(common[i].data());
    here[0] = real;
    here[1] = imaginary;
  }
  ends[0] = real;
  ends[1] = imaginary;
}

Transient LargestTransient(const SideBySide& residual, double resonance_Hz, double damping_ratio,
                           std::span<const double> gains) {
  const Complex step = std::exp(ResonancePole(resonance_Hz, damping_ratio) * residual.run().period_s);
  const std::vector<double> matched = MatchRinging(residual, step, gains);
  const double energy = RingingEnergy(step);
  const auto size = [](double a, double b) { return std::abs(a) < std::abs(b); };
  const auto best = std::max_element(matched.begin(), matched.end(), size);
  const auto sample = static_cast<std::size_t>(best - matched.begin());
  if (gains.empty()) return {sample, *best / energy, 1.0};
  double gain_square = 0.0;
  for (const double gain : gains) gain_square += gain * gain;
  const double height = *best / (energy * gain_square);
  return {sample, height * *best, height};
}

double TransientPower(const SideBySide& residual, double resonance_Hz, double damping_ratio, double least) {
  const Complex pole = ResonancePole(resonance_Hz, damping_ratio);
  const double period_s = residual.run().period_s;
  const Complex step = std::exp(pole * period_s);
  const std::vector<double> matched = MatchRinging(residual, step, {});
  const double energy = RingingEnergy(step);
  const auto window = static_cast<std::size_t>(std::max(1.0, -1.0 / (pole.real() * period_s)));
  double power = 0.0;
  for (std::size_t from = 0; from < matched.size(); from += window) {
    const auto first = matched.begin() + static_cast<std::ptrdiff_t>(from);
    const auto last = matched.begin() + static_cast<std::ptrdiff_t>(std::min(from + window, matched.size()));
    power += std::max(0.0, *std::max_element(first, last) / energy - least);
  }
  return power;
}

const Directions& Directions::Table() {
  static const Directions table;
  return table;
}

Directions::Directions() {
  for (std::size_t d = 0; d < kDirections; ++d)
    table_.push_back(std::polar(1.0, kTwoPi * static_cast<double>(d) / kDirections));
}

namespace {

InCommon Turned(const InCommon& values, Complex turn) {
  constexpr std::size_t kImaginary = SideBySide::kTogether;
  InCommon turned;
  for (std::size_t c = 0; c < kImaginary; ++c) {
    turned[c] = values[c] * turn.real() - values[kImaginary + c] * turn.imag();
    turned[kImaginary + c] = values[c] * turn.imag() + values[kImaginary + c] * turn.real();
  }
  return turned;
}

void Add(const InCommon& values, InCommon& sum) {
  for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += values[c];
}

// Power of what noise leaves in the sum over a train's impulses, beside that of as many whose responses do
// not overlap, each turned by where it stands on `side` turns of the angle.
double OverlapOf(const VibrationRun& run, const ImpulseTrain& train, double side) {
  constexpr int kPoints = 16;
  const Complex turn = std::polar(1.0, kTwoPi * side / train.order);
  double sum = 0.0;
  for (int p = 0; p < kPoints; ++p) {
    const std::size_t i = (2 * static_cast<std::size_t>(p) + 1) * run.size() / (2 * kPoints);
    const double apart_s = kTwoPi / (train.order * std::max(run.speed_rad_per_s[i], 1e-9));
    const Complex left = turn * std::exp(ResonancePole(train.resonance_Hz, train.damping_ratio) * apart_s);
    sum += ((1.0 + left) / (1.0 - left)).real() / kPoints;
  }
  return std::max(kLeastOverlap, sum);
}

}  // namespace

TrainMatch MatchTrain(const SideBySide& residual, const ImpulseTrain& train, double sideband,
                      double variance) {
  const VibrationRun& run = residual.run();
  // What a response that starts at a sample has in common with the residual behind it: a filter that runs
  // backwards. Turned to where the response would be in the middle of a bin of the impulse's period, the
  // samples of one bin add up.
  const std::size_t n = run.size();
  const std::size_t channels = run.channels.size();
  const Complex pole = ResonancePole(train.resonance_Hz, train.damping_ratio);
  const Complex step = std::exp(pole * run.period_s);
  const double impulses = train.order * run.turns;
  const double resonance_turns = train.resonance_Hz * run.span_s() / impulses;
  const auto most = static_cast<std::size_t>(std::max(4.0, static_cast<double>(n) / impulses));
  const auto bins = std::clamp<std::size_t>(
      static_cast<std::size_t>(kBinsPerDecay * kTwoPi * train.damping_ratio * resonance_turns), 4, most);
  const Directions& directions = Directions::Table();
  const double per_angle = train.order / kTwoPi;
  const double middle = 0.5 * run.angle_rad.back();
  const double resonance_turns_per_s = pole.imag() / kTwoPi;
  const double share_of_bin = 1.0 / static_cast<double>(bins);
  // By group of channels, then by bin.
  std::vector<InCommon> plain(bins * residual.groups());
  std::vector<InCommon> upper(sideband > 0.0 ? plain.size() : 0);
  std::vector<InCommon> lower(upper.size());
  MatchBackwards(residual, step, [&](std::size_t first, std::size_t i, const InCommon& common) {
    const double turn = (run.angle_rad[i] - middle) * per_angle;
    const double share = (turn - static_cast<double>(WholeBelow(turn))) * static_cast<double>(bins);
    const std::size_t own = std::min(bins - 1, static_cast<std::size_t>(share));
    const double off = (share - static_cast<double>(own) - 0.5) * share_of_bin;
    const double since_s = off / (per_angle * std::max(run.speed_rad_per_s[i], 1e-9));
    const std::size_t bin = first / SideBySide::kTogether * bins + own;
    const InCommon value = Turned(common, directions.After(resonance_turns_per_s * since_s - 0.25));
    Add(value, plain[bin]);
    if (!(sideband > 0.0)) return;
    const Complex slow = directions.After(-sideband / kTwoPi * run.angle_rad[i]);
    Add(Turned(value, slow), upper[bin]);
    Add(Turned(value, std::conj(slow)), lower[bin]);
  });
  const auto at = [&](const std::vector<InCommon>& sums, std::size_t c, std::size_t b) {
    const InCommon& group = sums[c / SideBySide::kTogether * bins + b];
    const std::size_t own = c % SideBySide::kTogether;
    return Complex(group[own], group[SideBySide::kTogether + own]);
  };
  // Samples that one impulse has in a bin, and the noise of a sum over the impulses.
  const double samples = static_cast<double>(n) / (impulses * static_cast<double>(bins));
  const double each = samples * samples * impulses * variance / (1.0 - std::norm(step));
  const double own_overlap = OverlapOf(run, train, 0.0);
  const double noise = each * own_overlap;
  const double beside_overlap = OverlapOf(run, train, sideband) + OverlapOf(run, train, -sideband);
  TrainMatch best;
  for (std::size_t b = 0; b < bins; ++b) {
    double sum = 0.0;
    Complex square{};
    for (std::size_t c = 0; c < channels; ++c) {
      sum += std::norm(at(plain, c, b));
      square += at(plain, c, b) * at(plain, c, b);
    }
    const double power = 0.5 * (sum + std::abs(square)) / noise;
    if (sideband <= 0.0 && power <= best.power) continue;
    const double phase = 0.5 * std::arg(square);
    TrainMatch match{power, 0.0, 0.0, 0.0};
    match.phase =
        (static_cast<double>(b) + 0.5) / static_cast<double>(bins) + phase / (kTwoPi * resonance_turns);
    if (sideband > 0.0) {
      const Complex back = std::polar(1.0, -phase);
      Complex above{};
      Complex below{};
      double gain = 0.0;
      for (std::size_t c = 0; c < channels; ++c) {
        const double own = (back * at(plain, c, b)).real();
        above += own * back * at(upper, c, b);
        below += own * back * at(lower, c, b);
        gain += own * own;
      }
      if (!(gain > 0.0)) continue;
      const Complex beside = above + std::conj(below);
      const Complex change = 2.0 * own_overlap / beside_overlap / gain * beside;
      match.cosine = change.real();
      match.sine = -change.imag();
      match.power += std::norm(beside) / (gain * each * beside_overlap);
    }
    if (match.power > best.power) best = match;
  }
  return best;
}

}  // namespace strainwave::analysis::diagnosis
