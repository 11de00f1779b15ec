// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/pulses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <utility>

#include "analysis/diagnosis/phasors.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

double Fall(double width, int harmonic) {
  const double x = kTwoPi * width * harmonic;
  return std::exp(-0.5 * x * x);
}

}  // namespace

int PulseHarmonics(double width, double order, double highest_order) {
  int count = 1;
  while (count < kPulseHarmonics && (count + 1) * order < highest_order && Fall(width, count + 1) > 1e-3)
    ++count;
  return count;
}

Eigen::VectorXd PulseColumn(const VibrationRun& run, const PulseTrain& train, double highest_order) {
  const int harmonics = PulseHarmonics(train.width, train.order, highest_order);
  std::array<double, kPulseHarmonics + 1> falls{};
  for (int k = 1; k <= harmonics; ++k) falls[static_cast<std::size_t>(k)] = Fall(train.width, k);
  Eigen::VectorXd column(static_cast<Eigen::Index>(run.size()));
  const double turned_rad = 0.5 * train.order * run.angle_rad.back() + kTwoPi * train.phase;
  const std::complex<double> start = std::polar(1.0, -turned_rad);
  ForEachPhasor(run.angle_rad, train.order, [&](std::size_t i, std::complex<double> phasor) {
    // Clenshaw's sum of cosines.
    const double cosine = Product(phasor, start).real();
    double next = 0.0;
    double after = 0.0;
    for (int k = harmonics; k >= 1; --k)
      after = std::exchange(next, falls[static_cast<std::size_t>(k)] + 2.0 * cosine * next - after);
    column(static_cast<Eigen::Index>(i)) = cosine * next - after;
  });
  if (train.cosine == 0.0 && train.sine == 0.0) return column;
  ForEachPhasor(run.angle_rad, train.slow_order, [&](std::size_t i, std::complex<double> phasor) {
    column(static_cast<Eigen::Index>(i)) *= 1.0 + train.cosine * phasor.real() + train.sine * phasor.imag();
  });
  return column;
}

PulseLines::PulseLines(const VibrationRun& run, double order, std::span<const double> residual,
                       std::span<const double> weights) {
  const std::complex<double> start = std::polar(1.0, -0.5 * order * run.angle_rad.back());
  of_channel_.resize(run.channels.size());
  ForEachPhasor(run.angle_rad, order, [&](std::size_t i, std::complex<double> phasor) {
    Lines turns{1.0};
    for (std::size_t k = 1; k < turns.size(); ++k) turns[k] = Product(turns[k - 1], Product(phasor, start));
    for (std::size_t c = 0; c < of_channel_.size(); ++c) {
      const std::size_t sample = run.channels[c].first + i;
      if (!(weights[sample] > 0.0)) continue;
      for (std::size_t k = 1; k < turns.size(); ++k) of_channel_[c][k] += residual[sample] * turns[k];
    }
  });
}

double PulseLines::BestPhase(double width, int harmonics) const {
  constexpr std::size_t kPhases = 4 * kPulseHarmonics;
  std::array<double, kPhases> power{};
  for (const Lines& lines : of_channel_) {
    for (std::size_t p = 0; p < kPhases; ++p) {
      double sum = 0.0;
      for (int k = 1; k <= harmonics; ++k) {
        const double angle = kTwoPi * k * static_cast<double>(p) / kPhases;
        sum += Fall(width, k) * (lines[static_cast<std::size_t>(k)] * std::polar(1.0, -angle)).real();
      }
      power[p] += sum * sum;
    }
  }
  const auto best = std::max_element(power.begin(), power.end());
  return static_cast<double>(best - power.begin()) / kPhases;
}

}  // namespace strainwave::analysis::diagnosis
