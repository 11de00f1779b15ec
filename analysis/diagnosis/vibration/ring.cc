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

Complex PoleOf(const RingTrain& train) {
  const double natural = kTwoPi * train.ring_Hz;
  return {-train.damping_ratio * natural,
          natural * std::sqrt(std::max(0.0, 1.0 - train.damping_ratio * train.damping_ratio))};
}

double Impulses(const VibrationRun& run, const RingTrain& train, std::size_t sample) {
  return (run.angle_rad[sample] - 0.5 * run.angle_rad.back()) * train.order / kTwoPi - train.phase;
}

}  // namespace

Eigen::VectorXd RingColumn(const VibrationRun& run, const RingTrain& train) {
  const std::size_t n = run.size();
  Eigen::VectorXd column(static_cast<Index>(n));
  const Complex pole = PoleOf(train);
  const Complex even_step = std::exp(pole * run.period_s);
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
  for (int back = 0; back < 200; ++back) {
    const double since_s = (begin - std::floor(begin) + back) * apart_s;
    const Complex left = std::exp(pole * since_s);
    if (std::norm(left) < 1e-8) break;
    state += weight_at(run.angle_rad.front() - since_s * first_speed) * left;
  }
  const double per_angle = train.order / kTwoPi;
  const double offset = 0.5 * run.angle_rad.back() * per_angle + train.phase;
  double next = std::floor(begin) + 1.0;
  for (std::size_t i = 0; i < n; ++i) {
    if (i > 0) {
      const double step_s = run.time_s[i] - run.time_s[i - 1];
      const bool even = std::abs(step_s - run.period_s) < 1e-9 * run.period_s;
      state *= even ? even_step : std::exp(pole * step_s);
      const double here = per_angle * run.angle_rad[i] - offset;
      for (; next <= here; next += 1.0) {
        const double before = per_angle * run.angle_rad[i - 1] - offset;
        const double share = (next - before) / (here - before);
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
  const Complex pole = PoleOf({0.0, ring_Hz, damping_ratio, 0.0, {}});
  const auto first = std::lower_bound(run.time_s.begin(), run.time_s.end(), start_s) - run.time_s.begin();
  const Complex even_step = std::exp(pole * run.period_s);
  Complex state = 1.0;
  double before_s = start_s;
  for (auto i = static_cast<std::size_t>(first); i < run.size() && std::norm(state) > 1e-8; ++i) {
    const double step_s = run.time_s[i] - before_s;
    state *= std::abs(step_s - run.period_s) < 1e-9 * run.period_s ? even_step : std::exp(pole * step_s);
    before_s = run.time_s[i];
    column(static_cast<Index>(i)) += height * state.imag();
  }
}

Kick LoudestKick(const VibrationRun& run, double ring_Hz, double damping_ratio,
                 std::span<const double> residual, std::span<const double> weights,
                 std::span<const double> gains) {
  const std::size_t n = run.size();
  const Complex step = std::exp(PoleOf({0.0, ring_Hz, damping_ratio, 0.0, {}}) * run.period_s);
  std::vector<double> matched(n, 0.0);
  double gain_square = 0.0;
  for (std::size_t c = 0; c < run.channels.size(); ++c) {
    Complex common{};
    const double gain = gains.empty() ? 1.0 : gains[c];
    gain_square += gain * gain;
    for (std::size_t i = n; i-- > 0;) {
      const std::size_t place = run.channels[c].first + i;
      common = common * step + (weights[place] > 0.0 ? residual[place] : 0.0);
      matched[i] += gains.empty() ? common.imag() * common.imag() : gain * common.imag();
    }
  }
  // A ring's sine has half of the energy 1 / (1 − |step|²).
  const double energy = 0.5 / (1.0 - std::norm(step));
  const auto size = [](double a, double b) { return std::abs(a) < std::abs(b); };
  const auto best = std::max_element(matched.begin(), matched.end(), size);
  const auto sample = static_cast<std::size_t>(best - matched.begin());
  if (gains.empty()) return {sample, *best / energy, 1.0};
  const double height = *best / (energy * gain_square);
  return {sample, height * *best, height};
}

double BestRingPhase(const VibrationRun& run, const RingTrain& train, std::span<const double> residual,
                     std::span<const double> weights) {
  // What a ring that starts at a sample has in common with the residual behind it: a filter that runs
  // backwards. Impulses of one phase then add up.
  const std::size_t n = run.size();
  const Complex step = std::exp(PoleOf(train) * run.period_s);
  const double ring_turns = train.ring_Hz * kTwoPi / (train.order * run.mean_speed_rad_per_s);
  const auto bins = static_cast<std::size_t>(std::clamp(8.0 * ring_turns, 32.0, 4096.0));
  std::vector<double> score(bins, 0.0);
  std::vector<Complex> sums(bins);
  for (const VibrationStretch& channel : run.channels) {
    std::fill(sums.begin(), sums.end(), Complex{});
    Complex common{};
    for (std::size_t i = n; i-- > 0;) {
      const std::size_t place = channel.first + i;
      common = common * step + (weights[place] > 0.0 ? residual[place] : 0.0);
      const double turn = Impulses(run, {train.order, 0.0, 0.0, 0.0, {}}, i);
      sums[static_cast<std::size_t>((turn - std::floor(turn)) * static_cast<double>(bins)) % bins] += common;
    }
    for (std::size_t b = 0; b < bins; ++b) score[b] += sums[b].imag() * sums[b].imag();
  }
  const auto best = std::max_element(score.begin(), score.end());
  return (static_cast<double>(best - score.begin()) + 0.5) / static_cast<double>(bins);
}

}  // namespace strainwave::analysis::diagnosis
