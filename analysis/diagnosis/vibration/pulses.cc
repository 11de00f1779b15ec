// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/pulses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

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
  const double middle = 0.5 * run.angle_rad.back();
  const bool even = train.cosine == 0.0 && train.sine == 0.0;
  for (std::size_t i = 0; i < run.size(); ++i) {
    const std::complex<double> turn =
        std::polar(1.0, train.order * (run.angle_rad[i] - middle) - kTwoPi * train.place);
    std::complex<double> line = 1.0;
    double sum = 0.0;
    for (int k = 1; k <= harmonics; ++k) {
      line *= turn;
      sum += falls[static_cast<std::size_t>(k)] * line.real();
    }
    if (!even) {
      const double slow = train.slow_order * run.angle_rad[i];
      sum *= 1.0 + train.cosine * std::cos(slow) + train.sine * std::sin(slow);
    }
    column(static_cast<Eigen::Index>(i)) = sum;
  }
  return column;
}

double BestPulsePlace(const VibrationRun& run, const PulseTrain& train, double highest_order,
                      std::span<const double> residual, std::span<const double> weights) {
  const int harmonics = PulseHarmonics(train.width, train.order, highest_order);
  const double middle = 0.5 * run.angle_rad.back();
  constexpr std::size_t kPlaces = 4 * kPulseHarmonics;
  std::array<double, kPlaces> power{};
  for (const VibrationStretch& channel : run.channels) {
    std::array<std::complex<double>, kPulseHarmonics + 1> lines{};
    for (std::size_t i = 0; i < run.size(); ++i) {
      if (!(weights[channel.first + i] > 0.0)) continue;
      const std::complex<double> turn = std::polar(1.0, train.order * (run.angle_rad[i] - middle));
      std::complex<double> line = residual[channel.first + i];
      for (int k = 1; k <= harmonics; ++k) {
        line *= turn;
        lines[static_cast<std::size_t>(k)] += line;
      }
    }
    for (std::size_t p = 0; p < kPlaces; ++p) {
      double sum = 0.0;
      for (int k = 1; k <= harmonics; ++k) {
        const double angle = kTwoPi * k * static_cast<double>(p) / kPlaces;
        sum += Fall(train.width, k) * (lines[static_cast<std::size_t>(k)] * std::polar(1.0, -angle)).real();
      }
      power[p] += sum * sum;
    }
  }
  const auto best = std::max_element(power.begin(), power.end());
  return static_cast<double>(best - power.begin()) / kPlaces;
}

}  // namespace strainwave::analysis::diagnosis
