// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/samples.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "analysis/diagnosis/motion/spikes.h"
#include "analysis/diagnosis/motion/time.h"
#include "analysis/diagnosis/motion/units.h"
#include "analysis/noise_level.h"
#include "analysis/samples/resolution.h"

namespace strainwave::analysis::diagnosis {
namespace {

using samples::QuantisationStep;

constexpr std::size_t kFewestSamples = 150;
constexpr double kClippedWarning = 0.005;
constexpr double kClippedError = 0.4;
constexpr std::size_t kFewLevels = 20;  // fewer torque levels are a command in steps, not a clipped signal

// Samples at one end of the torque's range, where it stays for three and more.
std::vector<bool> FindClipped(std::span<const double> torque) {
  std::vector<bool> clipped(torque.size(), false);
  std::set<double> levels;
  for (const double value : torque) {
    levels.insert(value);
    if (levels.size() > kFewLevels) break;
  }
  if (levels.size() <= kFewLevels) return clipped;
  const auto [low, high] = std::minmax_element(torque.begin(), torque.end());
  for (const double end : {*low, *high}) {
    for (std::size_t i = 0; i < torque.size();) {
      std::size_t next = i;
      while (next < torque.size() && torque[next] == end) ++next;
      if (next >= i + 3)
        std::fill(clipped.begin() + static_cast<std::ptrdiff_t>(i),
                  clipped.begin() + static_cast<std::ptrdiff_t>(next), true);
      i = std::max(next, i + 1);
    }
  }
  return clipped;
}

// An axis at rest shows no noise of a signal that is quantised.
std::vector<double> WithoutRests(std::span<const double> samples) {
  constexpr std::size_t kRest = 8;
  std::vector<double> moving;
  for (std::size_t i = 0; i < samples.size();) {
    std::size_t next = i;
    while (next < samples.size() && samples[next] == samples[i]) ++next;
    if (next - i < kRest)
      moving.insert(moving.end(), samples.begin() + static_cast<std::ptrdiff_t>(i),
                    samples.begin() + static_cast<std::ptrdiff_t>(next));
    i = next;
  }
  return moving;
}

void CheckTravel(const MotionData& record, const std::string& name) {
  const auto [low, high] = std::minmax_element(record.position.begin(), record.position.end());
  const double range = *high - *low;
  const NoiseLevel noise = EstimateNoise(record.position);
  if (range <= std::max(12.0 * noise.standard_deviation, 0.0) || !(range > 0.0)) {
    throw std::invalid_argument(
        fmt::format("{}the position stays within {:.3g} {} (expected an axis that moves)", name, range,
                    record.linear ? "m" : "rad"));
  }
}

// Before a low-pass spreads them.
std::vector<std::size_t> LeaveOutSpikes(MotionData& record, std::span<const std::size_t> kept,
                                        const std::string& name, std::vector<std::string>& warnings) {
  std::vector<std::size_t> spikes = BridgeSpikes(record, QuantisationStep(record.torque), kept);
  if (!spikes.empty()) {
    warnings.push_back(fmt::format("{}{} samples of the {} stand off their neighbours and were left out",
                                   name, spikes.size(), record.linear ? "force" : "torque"));
  }
  return spikes;
}

// Divided difference of uneven samples, in units in which white noise keeps its standard deviation.
double NormalisedDifference(std::span<const double> time_s, std::span<const double> values) {
  const double span_s = time_s.back() - time_s.front();
  double difference = 0.0;
  double squares = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    double weight = 1.0;
    for (std::size_t j = 0; j < values.size(); ++j) {
      if (j != k) weight *= span_s / (time_s[k] - time_s[j]);
    }
    difference += weight * values[k];
    squares += weight * weight;
  }
  return difference / std::sqrt(squares);
}

}  // namespace

double WhiteNoiseLevel(std::span<const double> samples) {
  if (samples.size() < 16) return 0.0;
  std::vector<double> differences(samples.begin(), samples.end());
  double least = 0.0;
  double gain = 1.0;  // sum of squared binomial coefficients: C(2p, p)
  for (int order = 1; order <= 8; ++order) {
    for (std::size_t i = 0; i + 1 < differences.size(); ++i)
      differences[i] = differences[i + 1] - differences[i];
    differences.pop_back();
    gain *= (4.0 * order - 2.0) / order;
    const double noise = RobustStandardDeviation(differences) / std::sqrt(gain);
    if (order == 1 || noise < least) least = noise;
  }
  return least;
}

double StampError_s(std::span<const double> time_s, std::span<const double> position) {
  constexpr std::size_t kFewest = 64;
  constexpr double kClearlyMore = 2.0;  // times the variance of a slow axis
  if (position.size() < kFewest) return 0.0;
  std::vector<double> speeds(position.size(), 0.0);
  for (std::size_t i = 1; i + 1 < position.size(); ++i)
    speeds[i] = std::abs(position[i + 1] - position[i - 1]) / (time_s[i + 1] - time_s[i - 1]);
  const double fastest = QuantileOfMagnitude(speeds, 0.95);
  // The order that leaves least of the fast part: what is left of its motion is no more than that.
  double least = std::numeric_limits<double>::max();
  double stamp_error_s = 0.0;
  for (std::size_t order = 1; order <= 8; ++order) {
    std::vector<double> of_slow;
    std::vector<double> of_fast;
    double squared_speed_of_slow = 0.0;
    double squared_speed_of_fast = 0.0;
    for (std::size_t i = 0; i + order < position.size(); ++i) {
      const double difference =
          NormalisedDifference(time_s.subspan(i, order + 1), position.subspan(i, order + 1));
      const double speed = speeds[i + order / 2];
      const bool fast = speed > 0.5 * fastest;
      (fast ? of_fast : of_slow).push_back(difference);
      (fast ? squared_speed_of_fast : squared_speed_of_slow) += speed * speed;
    }
    if (of_slow.size() < kFewest / 4 || of_fast.size() < kFewest / 4) return 0.0;
    squared_speed_of_fast /= static_cast<double>(of_fast.size());
    squared_speed_of_slow /= static_cast<double>(of_slow.size());
    const double in_motion = std::pow(RobustStandardDeviation(of_fast), 2);
    const double slow = std::pow(RobustStandardDeviation(of_slow), 2);
    if (in_motion > least) continue;
    least = in_motion;
    stamp_error_s = in_motion > kClearlyMore * slow
                        ? std::sqrt((in_motion - slow) / (squared_speed_of_fast - squared_speed_of_slow))
                        : 0.0;
  }
  return stamp_error_s;
}

double QuantileOfMagnitude(std::span<const double> values, double share) {
  if (values.empty()) return 0.0;
  std::vector<double> magnitudes;
  for (const double value : values) magnitudes.push_back(std::abs(value));
  const auto quantile =
      magnitudes.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(magnitudes.begin(), quantile, magnitudes.end());
  return *quantile;
}

double UsualSize(std::span<const double> values) {
  constexpr double kNormalQuantile = 1.28155;  // four fifths of a standard normal distribution
  return QuantileOfMagnitude(values, 0.8) / kNormalQuantile;
}

MotionSamples PrepareMotion(std::span<const MotionData> records,
                            std::span<const std::vector<std::size_t>> kept) {
  MotionSamples samples;
  samples.records = records.size();
  if (records.empty()) throw std::invalid_argument("no motion record (expected at least one)");
  samples.linear = records.front().linear;
  std::vector<double> position_noise;
  std::vector<double> stamp_error_s;
  std::vector<double> velocity_noise;
  std::vector<double> torque_noise;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const std::string name = records.size() > 1 ? fmt::format("record {}: ", r + 1) : std::string{};
    MotionData record = records[r];
    if (record.linear != samples.linear) {
      throw std::invalid_argument(
          fmt::format("{}a linear axis and a rotary one together (expected records of one "
                      "axis)",
                      name));
    }
    if (record.time_s.size() < kFewestSamples) {
      throw std::invalid_argument(
          fmt::format("{}{} samples are too few to hold any out (expected at least {})", name,
                      record.time_s.size(), kFewestSamples));
    }
    if (record.inertia && !samples.inertia) samples.inertia = record.inertia;
    CheckTravel(record, name);
    const auto [low, high] = std::minmax_element(record.torque.begin(), record.torque.end());
    if (!(*high > *low)) {
      throw std::invalid_argument(fmt::format("{}the {} is {:.4g} {} throughout (expected one that changes)",
                                              name, record.linear ? "force" : "torque", *low,
                                              record.linear ? "N" : "Nm"));
    }
    std::vector<bool> unknown = FindClipped(record.torque);
    const double share = static_cast<double>(std::count(unknown.begin(), unknown.end(), true)) /
                         static_cast<double>(unknown.size());
    if (share > kClippedWarning) {
      const std::string text = fmt::format(
          "{}{:.0f} % of the samples stand at the end of the {}'s range ({:.4g} to {:.4g} "
          "{}): saturated",
          name, 100.0 * share, record.linear ? "force" : "torque", *low, *high, record.linear ? "N" : "Nm");
      if (share > kClippedError) throw std::invalid_argument(text + " (expected a record inside the range)");
      samples.warnings.push_back(text + "; they are left out");
    }
    samples.spikes.push_back(LeaveOutSpikes(record, kept.empty() ? std::span<const std::size_t>{} : kept[r],
                                            name, samples.warnings));
    // What bridges the top of an acceleration transient is not the torque.
    for (const std::size_t spike : samples.spikes.back()) unknown[spike] = true;
    SettleUnits(record, name, samples.warnings);
    const double step = QuantisationStep(record.position);
    samples.position_step = std::max(samples.position_step, step);
    // Of the samples as they came: bringing them onto even steps smooths them.
    torque_noise.push_back(
        std::max(WhiteNoiseLevel(record.torque), QuantisationStep(record.torque) / std::sqrt(12.0)));
    for (EvenSegment& segment : EvenSegments(record, unknown, name, samples.warnings)) {
      segment.record = r;
      position_noise.push_back(
          std::max(WhiteNoiseLevel(WithoutRests(segment.position)), step / std::sqrt(12.0)));
      stamp_error_s.push_back(segment.stamp_error_s);
      if (!segment.velocity.empty()) {
        velocity_noise.push_back(std::max(WhiteNoiseLevel(WithoutRests(segment.velocity)),
                                          QuantisationStep(segment.velocity) / std::sqrt(12.0)));
      }
      samples.segments.push_back(std::move(segment));
    }
  }
  if (samples.segments.empty()) {
    throw std::invalid_argument("no stretch without a gap is long enough (expected 40 samples and more)");
  }
  samples.position_noise = Median(position_noise);
  samples.stamp_error_s = Median(stamp_error_s);
  samples.velocity_noise = Median(velocity_noise);
  samples.torque_noise = Median(torque_noise);
  return samples;
}

}  // namespace strainwave::analysis::diagnosis
