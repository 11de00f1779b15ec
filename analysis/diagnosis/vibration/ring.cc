// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/ring.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

constexpr double kBinsPerDecay = 4.0;
constexpr double kLeastOverlap = 0.05;

Complex PoleOf(const RingTrain& train) { return RingPole(train.ring_Hz, train.damping_ratio); }

// What a ring is turned and damped by from sample to sample. Steps are even but for the last digit of their
// time stamps, for which a few powers do.
class RingStep {
 public:
  RingStep(Complex pole, double period_s)
      : pole_(pole), period_s_(period_s), even_(std::exp(pole * period_s)) {}

  Complex operator()(double step_s) const {
    constexpr double kSmall = 1e-4;  // of a squared turn: the next power is below 1e-12
    const Complex more = pole_ * (step_s - period_s_);
    if (!(std::norm(more) < kSmall)) return std::exp(pole_ * step_s);
    // What time stamps are rounded by: the square is lost in the last digit of one.
    constexpr double kRounding = 1e-18;
    if (std::norm(more) < kRounding) return Product(even_, 1.0 + more);
    const Complex powers = 1.0 + Product(more / 2.0, 1.0 + Product(more / 3.0, 1.0 + more / 4.0));
    return Product(even_, 1.0 + Product(more, powers));
  }

 private:
  Complex pole_;
  double period_s_;
  Complex even_;
};

double Impulses(const VibrationRun& run, const RingTrain& train, std::size_t sample) {
  return (run.angle_rad[sample] - 0.5 * run.angle_rad.back()) * train.order / kTwoPi - train.phase;
}

}  // namespace

Complex RingPole(double ring_Hz, double damping_ratio) {
  const double natural = kTwoPi * ring_Hz;
  return {-damping_ratio * natural, natural * std::sqrt(std::max(0.0, 1.0 - damping_ratio * damping_ratio))};
}

double RingTrain::SlipOf(double impulse) const {
  if (slips.empty()) return 0.0;
  const auto last = static_cast<double>(slips.size() - 1);
  return slips[static_cast<std::size_t>(std::clamp(impulse + std::floor(0.5 * last), 0.0, last))];
}

Eigen::VectorXd RingColumn(const VibrationRun& run, const RingTrain& train) {
  const std::size_t n = run.size();
  Eigen::VectorXd column(static_cast<Index>(n));
  const Complex pole = PoleOf(train);
  const RingStep step(pole, run.period_s);
  const auto weight_at = [&train](double angle) {
    double weight = 1.0;
    for (const RingModulation& modulation : train.modulations) {
      weight += modulation.cosine * std::cos(modulation.order * angle) +
                modulation.sine * std::sin(modulation.order * angle);
    }
    return weight;
  };
  Complex state;
  // What rang before the record began: the train goes on backwards at the first speed until it has died away.
  const double first_speed = std::max(run.speed_rad_per_s.front(), 1e-9);
  const double apart_s = kTwoPi / (train.order * first_speed);
  const double begin = Impulses(run, train, 0);
  const auto place_of = [&train](double impulse) { return impulse + train.SlipOf(impulse); };
  double next = std::floor(begin) + 1.0;
  while (place_of(next) <= begin) next += 1.0;
  while (place_of(next - 1.0) > begin) next -= 1.0;
  for (int back = 1; back <= 200; ++back) {
    const double since_s = (begin - place_of(next - back)) * apart_s;
    const Complex left = std::exp(pole * since_s);
    if (std::norm(left) < 1e-8) break;
    state += weight_at(run.angle_rad.front() - since_s * first_speed) * left;
  }
  const double per_angle = train.order / kTwoPi;
  const double offset = 0.5 * run.angle_rad.back() * per_angle + train.phase;
  for (std::size_t i = 0; i < n; ++i) {
    if (i > 0) {
      const double step_s = run.time_s[i] - run.time_s[i - 1];
      state = Product(state, step(step_s));
      const double here = per_angle * run.angle_rad[i] - offset;
      for (; place_of(next) <= here; next += 1.0) {
        const double before = per_angle * run.angle_rad[i - 1] - offset;
        const double share = (place_of(next) - before) / (here - before);
        state += weight_at(run.angle_rad[i - 1] + share * (run.angle_rad[i] - run.angle_rad[i - 1])) *
                 std::exp(pole * ((1.0 - share) * step_s));
      }
    }
    column(static_cast<Index>(i)) = state.imag();
  }
  return column;
}

void AddKick(const VibrationRun& run, double ring_Hz, double damping_ratio, double start_s, double height,
             Eigen::Ref<Eigen::VectorXd> column) {
  const Complex pole = RingPole(ring_Hz, damping_ratio);
  const auto first = std::lower_bound(run.time_s.begin(), run.time_s.end(), start_s) - run.time_s.begin();
  const RingStep step(pole, run.period_s);
  Complex state = 1.0;
  double before_s = start_s;
  for (auto i = static_cast<std::size_t>(first); i < run.size() && std::norm(state) > 1e-8; ++i) {
    state = Product(state, step(run.time_s[i] - before_s));
    before_s = run.time_s[i];
    column(static_cast<Index>(i)) += height * state.imag();
  }
}

Knock OneOf(const Knock& first, const Knock& second, double ring_Hz, double damping_ratio) {
  const Complex pole = RingPole(ring_Hz, damping_ratio);
  // Size and phase at the start of the first; the sign makes up for half a turn of the phase.
  const Complex sum = first.height + second.height * std::exp(pole * (first.start_s - second.start_s));
  const double sign = sum.real() < 0.0 ? -1.0 : 1.0;
  const double later_s = -std::arg(sign * sum) / pole.imag();
  return {first.start_s + later_s, sign * std::abs(sum) * std::exp(pole.real() * later_s)};
}

namespace {

// What a ring that starts at each sample has in common with a residual: squares, summed over the channels, or
// where their gains are known the common amplitude.
std::vector<double> MatchRing(const VibrationRun& run, Complex step, std::span<const double> residual,
                              std::span<const double> weights, std::span<const double> gains) {
  std::vector<double> matched(run.size(), 0.0);
  if (gains.empty()) {
    MatchBackwards(run, step, residual, weights, [&](std::size_t, std::size_t i, Complex common) {
      matched[i] += common.imag() * common.imag();
    });
  } else {
    MatchBackwards(run, step, residual, weights, [&](std::size_t c, std::size_t i, Complex common) {
      matched[i] += gains[c] * common.imag();
    });
  }
  return matched;
}

// A ring's sine has half of the energy 1 / (1 − |step|²).
double RingEnergy(Complex step) { return 0.5 / (1.0 - std::norm(step)); }

}  // namespace

Kick LoudestKick(const VibrationRun& run, double ring_Hz, double damping_ratio,
                 std::span<const double> residual, std::span<const double> weights,
                 std::span<const double> gains) {
  const Complex step = std::exp(RingPole(ring_Hz, damping_ratio) * run.period_s);
  const std::vector<double> matched = MatchRing(run, step, residual, weights, gains);
  const double energy = RingEnergy(step);
  const auto size = [](double a, double b) { return std::abs(a) < std::abs(b); };
  const auto best = std::max_element(matched.begin(), matched.end(), size);
  const auto sample = static_cast<std::size_t>(best - matched.begin());
  if (gains.empty()) return {sample, *best / energy, 1.0};
  double gain_square = 0.0;
  for (const double gain : gains) gain_square += gain * gain;
  const double height = *best / (energy * gain_square);
  return {sample, height * *best, height};
}

double KickPower(const VibrationRun& run, double ring_Hz, double damping_ratio,
                 std::span<const double> residual, std::span<const double> weights, double least) {
  const Complex pole = RingPole(ring_Hz, damping_ratio);
  const Complex step = std::exp(pole * run.period_s);
  const std::vector<double> matched = MatchRing(run, step, residual, weights, {});
  const double energy = RingEnergy(step);
  const auto window = static_cast<std::size_t>(std::max(1.0, -1.0 / (pole.real() * run.period_s)));
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

// Power of what noise leaves in the sum over a train's impulses, beside that of as many which do not ring
// into one another, each turned by where it stands on `side` turns of the angle.
double OverlapOf(const VibrationRun& run, const RingTrain& train, double side) {
  constexpr int kPlaces = 16;
  const Complex turn = std::polar(1.0, kTwoPi * side / train.order);
  double sum = 0.0;
  for (int p = 0; p < kPlaces; ++p) {
    const std::size_t i = (2 * static_cast<std::size_t>(p) + 1) * run.size() / (2 * kPlaces);
    const double apart_s = kTwoPi / (train.order * std::max(run.speed_rad_per_s[i], 1e-9));
    const Complex left = turn * std::exp(PoleOf(train) * apart_s);
    sum += ((1.0 + left) / (1.0 - left)).real() / kPlaces;
  }
  return std::max(kLeastOverlap, sum);
}

}  // namespace

TrainMatch MatchTrain(const VibrationRun& run, const RingTrain& train, double sideband,
                      std::span<const double> residual, std::span<const double> weights, double variance) {
  // What a ring that starts at a sample has in common with the residual behind it: a filter that runs
  // backwards. Turned to where the ring would be in the middle of a bin of the impulse's period, the samples
  // of one bin add up.
  const std::size_t n = run.size();
  const std::size_t channels = run.channels.size();
  const Complex pole = PoleOf(train);
  const Complex step = std::exp(pole * run.period_s);
  const double impulses = train.order * run.turns;
  const double ring_turns = train.ring_Hz * run.span_s() / impulses;
  const auto most = static_cast<std::size_t>(std::max(4.0, static_cast<double>(n) / impulses));
  const auto bins = std::clamp<std::size_t>(
      static_cast<std::size_t>(kBinsPerDecay * kTwoPi * train.damping_ratio * ring_turns), 4, most);
  struct Place {
    std::size_t bin;
    Complex turn;
    Complex slow;
  };
  const Directions& directions = Directions::Table();
  std::vector<Place> places(n);
  const double per_angle = train.order / kTwoPi;
  const double middle = 0.5 * run.angle_rad.back();
  const double ring_turns_per_s = pole.imag() / kTwoPi;
  for (std::size_t i = 0; i < n; ++i) {
    const double turn = (run.angle_rad[i] - middle) * per_angle;
    const double share = (turn - static_cast<double>(WholeBelow(turn))) * static_cast<double>(bins);
    const std::size_t bin = std::min(bins - 1, static_cast<std::size_t>(share));
    const double off = (share - static_cast<double>(bin) - 0.5) / static_cast<double>(bins);
    const double since_s = off / (per_angle * std::max(run.speed_rad_per_s[i], 1e-9));
    places[i] = {bin, directions.After(ring_turns_per_s * since_s - 0.25),
                 sideband > 0.0 ? directions.After(-sideband / kTwoPi * run.angle_rad[i]) : Complex{}};
  }
  std::vector<Complex> plain(bins * channels);
  std::vector<Complex> upper(sideband > 0.0 ? bins * channels : 0);
  std::vector<Complex> lower(upper.size());
  if (sideband > 0.0) {
    MatchBackwards(run, step, residual, weights, [&](std::size_t c, std::size_t i, Complex common) {
      const Complex value = Product(common, places[i].turn);
      const std::size_t bin = c * bins + places[i].bin;
      plain[bin] += value;
      upper[bin] += Product(value, places[i].slow);
      lower[bin] += Product(value, std::conj(places[i].slow));
    });
  } else {
    MatchBackwards(run, step, residual, weights, [&](std::size_t c, std::size_t i, Complex common) {
      plain[c * bins + places[i].bin] += Product(common, places[i].turn);
    });
  }
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
      sum += std::norm(plain[c * bins + b]);
      square += plain[c * bins + b] * plain[c * bins + b];
    }
    const double power = 0.5 * (sum + std::abs(square)) / noise;
    if (sideband <= 0.0 && power <= best.power) continue;
    const double phase = 0.5 * std::arg(square);
    TrainMatch match{power, 0.0, 0.0, 0.0};
    match.phase = (static_cast<double>(b) + 0.5) / static_cast<double>(bins) + phase / (kTwoPi * ring_turns);
    if (sideband > 0.0) {
      const Complex back = std::polar(1.0, -phase);
      Complex above{};
      Complex below{};
      double gain = 0.0;
      for (std::size_t c = 0; c < channels; ++c) {
        const double own = (back * plain[c * bins + b]).real();
        above += own * back * upper[c * bins + b];
        below += own * back * lower[c * bins + b];
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
