// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/impacts.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "analysis/diagnosis/motion/backlash.h"
#include "analysis/diagnosis/motion/bandwidth.h"
#include "analysis/diagnosis/motion/settled_grid.h"
#include "analysis/noise_level.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr std::size_t kFewest = 2;  // spikes that are impacts: one alone is anything's
constexpr double kExplained = 0.5;  // of a spike's height, that may be left of an impact
// Of −2 log-likelihood, what a sample costs that is called a spike: one of 300, anywhere within 30 standard
// deviations of the noise to either side. Nothing costs more.
constexpr double kSpike = 18.0;

// What the fit of a cause without its low-pass leaves of the torque at the points; `fit` without a cause has
// the nominal numbers alone.
std::vector<double> LeftAtPoints(const MotionSamples& samples, const MotionGrid& grid, const ModelFit& fit) {
  const auto nominal = static_cast<std::size_t>(grid.nominal.cols());
  const std::vector<double>& numbers = fit.state;
  std::vector<double> left(grid.time_s.size(), 0.0);
  if (!fit.causes.empty()) {
    left = InertiaBehindBacklashAtPoints(grid, std::span(numbers).subspan(nominal + 1));
    for (double& value : left) value *= -numbers[nominal];
  }
  for (std::size_t s = 0; s < grid.segments.size(); ++s) {
    const MotionGrid::Segment& segment = grid.segments[s];
    for (std::size_t k = 0; k < segment.count; ++k) {
      const std::size_t i = segment.first + k;
      left[i] += samples.segments[s].torque[k] - numbers[0] * grid.passed_acceleration[i] -
                 numbers[1] * grid.velocity[i] - numbers[2] * grid.direction[i] - numbers[3 + segment.record];
    }
  }
  return left;
}

// −2 log-likelihood, up to a constant.
double CostOf(std::span<const double> left, double noise) {
  double cost = 0.0;
  for (const double value : left) cost += std::min(std::pow(value / noise, 2), kSpike);
  return cost;
}

std::size_t CountOf(const std::vector<std::vector<std::size_t>>& of_each_record) {
  std::size_t count = 0;
  for (const std::vector<std::size_t>& samples : of_each_record) count += samples.size();
  return count;
}

// Of the spikes of each record, those of which the inertia behind backlash leaves little.
std::vector<std::vector<std::size_t>> Explained(std::span<const MotionData> records,
                                                const std::vector<std::vector<std::size_t>>& spikes,
                                                const MotionGrid& grid, std::span<const double> before,
                                                std::span<const double> after) {
  std::vector<std::vector<std::size_t>> explained(spikes.size());
  for (std::size_t r = 0; r < spikes.size(); ++r) {
    for (const std::size_t spike : spikes[r]) {
      for (const MotionGrid::Segment& segment : grid.segments) {
        if (segment.record != r) continue;
        const double steps = (records[r].time_s[spike] - grid.time_s[segment.first]) / segment.step_s;
        const auto k = static_cast<std::ptrdiff_t>(std::lround(steps));
        if (k < 0 || k >= static_cast<std::ptrdiff_t>(segment.count)) continue;
        const std::size_t point = segment.first + static_cast<std::size_t>(k);
        if (std::abs(after[point]) < kExplained * std::abs(before[point])) explained[r].push_back(spike);
      }
    }
  }
  return explained;
}

}  // namespace

MotionSamples KeepImpacts(std::span<const MotionData> records, MotionSamples samples) {
  if (CountOf(samples.spikes) < kFewest) return samples;
  const MotionSamples all = PrepareMotion(records, samples.spikes);
  const MotionBandwidth bandwidth = ChooseBandwidth(samples, kMostRows);
  for (const EvenSegment& segment : all.segments) {
    // Where the torque is sampled much faster than it can be looked at, no impact is that short.
    if (!KeepsUpWith(bandwidth, segment.step_s)) return samples;
  }
  const SharedGrid grid = WithoutLowPass(all, bandwidth);
  SeparableModel model;
  model.measured = grid->measured;
  model.segments = grid->response_segments;
  AddNominalMotion(grid, MotionUnits{all.linear}, model);
  AddBacklash(grid, MotionUnits{all.linear}, model);
  if (model.causes.empty()) return samples;
  const int numbers = model.rules.front().degrees_of_freedom;
  const SeparableStudy study(std::move(model));
  const ModelFit without = study.Fit({}, grid->weights, nullptr, FitPurpose::kCompare);
  const std::size_t loose[] = {0};
  const ModelFit with = study.Fit(loose, grid->weights, &without, FitPurpose::kCompare);
  if (!with.usable) return samples;
  const std::vector<double> before = LeftAtPoints(all, *grid, without);
  const std::vector<double> after = LeftAtPoints(all, *grid, with);
  const double noise = RobustStandardDeviation(after);
  const double gain = CostOf(before, noise) - CostOf(after, noise);
  if (!(gain > numbers * std::log(static_cast<double>(after.size())))) return samples;
  const auto impacts = Explained(records, samples.spikes, *grid, before, after);
  return CountOf(impacts) < kFewest ? samples : PrepareMotion(records, impacts);
}

}  // namespace strainwave::analysis::diagnosis
