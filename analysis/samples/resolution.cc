// SPDX-License-Identifier: Apache-2.0
#include "analysis/samples/resolution.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <vector>

#include "analysis/noise_level.h"
#include "analysis/units.h"

namespace strainwave::analysis::samples {
namespace {

// Whether nearly all changes are whole multiples of a step.
bool IsStepOf(std::span<const double> changes, double step, double tolerance) {
  std::size_t whole = 0;
  std::size_t small = 0;
  for (const double change : changes) {
    const double multiple = change / step;
    if (multiple > 50.0) continue;  // rounding of the file would blur them
    ++small;
    if (std::abs(multiple - std::round(multiple)) < tolerance) ++whole;
  }
  return small > 20 && static_cast<double>(whole) > 0.9 * static_cast<double>(small);
}

}  // namespace

double QuantisationStep(std::span<const double> samples, double tolerance) {
  std::vector<double> changes;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double change = std::abs(samples[i] - samples[i - 1]);
    if (change > 0.0) changes.push_back(change);
  }
  if (changes.size() < 8) return 0.0;
  std::sort(changes.begin(), changes.end());
  // Of an axis that is fast nearly always few changes are that small.
  for (const std::size_t share : {50, 200, 1000}) {
    const double step = changes[changes.size() / share];
    if (IsStepOf(changes, step, tolerance)) return step;
  }
  return 0.0;
}

bool StandsOnSteps(std::span<const double> samples, double step) {
  constexpr double kAlike = 0.9;  // mean of the phases' vectors; 1 on steps, near 0 anywhere
  // Over the whole range the file's last digits would add up.
  double way = 0.0;
  double steps = 0.0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    way += std::abs(samples[i] - samples[i - 1]);
    steps += std::round(std::abs(samples[i] - samples[i - 1]) / step);
  }
  const double mean_step = way / steps;
  std::complex<double> sum;
  for (const double sample : samples) sum += std::polar(1.0, kTwoPi * (sample - samples.front()) / mean_step);
  return std::abs(sum) > kAlike * static_cast<double>(samples.size());
}

double QuantisationStepOfSweep(std::span<const double> samples) {
  constexpr double kTolerance = 0.05;  // steps
  // Of a move: what a file's last digits make of equal moves is no difference.
  constexpr double kDigit = 1e-6;
  std::vector<double> moves;
  for (std::size_t i = 1; i < samples.size(); ++i) moves.push_back(std::abs(samples[i] - samples[i - 1]));
  if (moves.empty()) return 0.0;
  const double digit = kDigit * Median(moves);
  if (!(digit > 0.0)) return QuantisationStep(samples);
  for (double& move : moves) move = digit * std::round(move / digit);
  const double step = QuantisationStep(moves);
  if (!(step > 0.0)) return 0.0;
  // Moves that a harmonic makes long and short in turn differ by one amount, too, of which they are no
  // multiples.
  const auto whole = std::ranges::count_if(
      moves, [&](double move) { return std::abs(std::remainder(move, step)) < kTolerance * step; });
  return static_cast<double>(whole) > 0.9 * static_cast<double>(moves.size()) ? step : 0.0;
}

}  // namespace strainwave::analysis::samples
