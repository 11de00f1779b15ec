// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/diagnosis/separable_fit.h"
#include "analysis/diagnosis/transmission_error/terms.h"
#include "analysis/noise_level.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr std::size_t kEnoughPairs = 60;

// What lines of known orders, offsets and a slow drift leave.
std::vector<double> Remaining(const TransmissionErrorSamples& samples) {
  const std::size_t n = samples.error_rad.size();
  std::vector<SeparableTerm> terms;
  for (std::size_t record = 0; record < samples.records; ++record) {
    for (const double direction : {1.0, -1.0}) {
      std::vector<double> here(n, 0.0);
      for (std::size_t i = 0; i < n; ++i) {
        here[i] = samples.record[i] == record && samples.direction[i] == direction ? 1.0 : 0.0;
      }
      terms.push_back(ColumnTerm(here, {}));
      const double first = samples.time_s.front();
      for (std::size_t i = 0; i < n; ++i) here[i] *= samples.time_s[i] - first;
      terms.push_back(ColumnTerm(std::move(here), {}));
    }
  }
  for (const double order : {1.0, 2.0, 4.0})
    terms.push_back(HarmonicTerm(samples.input_rad, order, "", "", 1.0));
  for (const double order : {1.0, 2.0, 2.0 * std::abs(samples.ratio) + 2.0}) {
    terms.push_back(HarmonicTerm(samples.output_rad, order, "", "", 1.0));
  }
  TermSet set;
  set.samples = n;
  for (const SeparableTerm& term : terms) set.terms.push_back(&term);
  const std::vector<double> weights(n, 1.0);
  const SeparableSolution solution =
      SeparableProblem(set, samples.error_rad, weights).Solve(std::vector<std::vector<double>>(terms.size()));
  std::vector<double> left(samples.error_rad);
  for (std::size_t i = 0; i < n; ++i) left[i] -= solution.predicted(static_cast<Eigen::Index>(i));
  return left;
}

}  // namespace

double TransmissionErrorFloor_rad(const TransmissionErrorSamples& samples) {
  const std::vector<double> left = Remaining(samples);
  // Pairs of samples at one output angle (mod a turn), taken at different times: neighbours in angle, at most
  // a quarter step apart, and far apart in the record.
  std::vector<std::size_t> order(left.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<double> turn_angle(samples.output_rad);
  for (double& angle : turn_angle) angle -= kTwoPi * std::floor(angle / kTwoPi + 1e-4);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return turn_angle[a] < turn_angle[b]; });
  const double step = samples.samples_per_turn > 0.0 ? kTwoPi / samples.samples_per_turn : 0.0;
  std::vector<double> differences;
  for (std::size_t i = 0; i + 1 < order.size(); ++i) {
    const std::size_t a = order[i];
    const std::size_t b = order[i + 1];
    const std::size_t apart = a > b ? a - b : b - a;
    if (!(turn_angle[b] - turn_angle[a] < 0.25 * step) || apart < 4) continue;
    differences.push_back((left[a] - left[b]) / std::sqrt(2.0));
    ++i;
  }
  if (differences.size() >= kEnoughPairs) {
    double sum = 0.0;
    for (const double difference : differences) sum += difference * difference;
    const double plain = std::sqrt(sum / static_cast<double>(differences.size()));
    const double robust = RobustStandardDeviation(differences);
    // Outliers aside, the plain one is twice as sharp.
    return plain < 1.15 * robust ? plain : robust;
  }
  return EstimateNoise(left).standard_deviation;
}

}  // namespace strainwave::analysis::diagnosis
