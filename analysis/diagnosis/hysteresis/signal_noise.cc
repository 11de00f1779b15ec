// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "analysis/diagnosis/hysteresis/signal.h"
#include "analysis/noise_level.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Fourth differences over time, in which cubic pieces vanish wherever their samples lie, as large as white
// noise itself.
std::vector<double> FourthDifferences(std::span<const double> t, std::span<const double> x) {
  constexpr std::size_t kPoints = 5;
  std::vector<double> differences;
  for (std::size_t i = kPoints - 1; i < x.size(); ++i) {
    const std::size_t first = i + 1 - kPoints;
    const double scale_s = t[i] - t[first];  // or products of five steps leave the range of numbers
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t j = first; j <= i; ++j) {
      double product = 1.0;
      for (std::size_t k = first; k <= i; ++k) {
        if (k != j) product *= (t[j] - t[k]) / scale_s;
      }
      sum += x[j] / product;
      squares += 1.0 / (product * product);
    }
    if (std::isfinite(sum) && std::isfinite(squares)) differences.push_back(sum / std::sqrt(squares));
  }
  return differences;
}

std::vector<double> NeighbourDifferences(std::span<const double> x) {
  std::vector<double> differences;
  for (std::size_t i = 1; i < x.size(); ++i) differences.push_back(x[i] - x[i - 1]);
  return differences;
}

// First samples behind the gaps of a record, between the first and the number of samples: steps of many, of
// which there are few. Stamps that come in bunches have many.
std::vector<std::size_t> Runs(std::span<const double> time_s) {
  constexpr double kNoJitter = 8.0;  // of a mean step: no stamp jitters that far
  constexpr double kFew = 0.01;      // of the samples
  const double gap_s = kNoJitter * (time_s.back() - time_s.front()) / static_cast<double>(time_s.size() - 1);
  std::vector<std::size_t> runs{0};
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    if (time_s[i] - time_s[i - 1] > gap_s) runs.push_back(i);
  }
  if (static_cast<double>(runs.size() - 1) > kFew * static_cast<double>(time_s.size())) runs.resize(1);
  runs.push_back(time_s.size());
  return runs;
}

// The same segments of time in even steps.
std::vector<double> EvenTimes(std::span<const double> time_s) {
  std::vector<double> even_s;
  const std::vector<std::size_t> runs = Runs(time_s);
  for (std::size_t r = 0; r + 1 < runs.size(); ++r) {
    const std::size_t last = runs[r + 1] - 1;
    const double begin_s = time_s[runs[r]];
    const double steps = std::max(1.0, static_cast<double>(last - runs[r]));
    for (std::size_t i = runs[r]; i <= last; ++i)
      even_s.push_back(begin_s + (time_s[last] - begin_s) * static_cast<double>(i - runs[r]) / steps);
  }
  return even_s;
}

}  // namespace

double RoundingNoise(std::span<const double> signal, double share) {
  std::size_t repeated = 0;
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < signal.size(); ++i) {
    const double difference = std::abs(signal[i] - signal[i - 1]);
    if (difference == 0.0) {
      ++repeated;
    } else {
      step = std::min(step, difference);
    }
  }
  const bool stands = static_cast<double>(repeated) > share * static_cast<double>(signal.size());
  return stands && std::isfinite(step) ? step / std::sqrt(12.0) : 0.0;
}

double SampleNoise(std::span<const double> time_s, std::span<const double> signal) {
  if (signal.size() < 6) return 0.0;
  constexpr double kSteps = 0.1;
  // Either is too large where the signal moves in its way: a ramp for neighbours, a stair of a few samples a
  // step for the fourth differences, of which most then hold a riser.
  double white = RobustStandardDeviation(FourthDifferences(time_s, signal));
  const double of_neighbours = RobustStandardDeviation(NeighbourDifferences(signal)) / std::sqrt(2.0);
  if (of_neighbours > 0.0) white = std::min(white, of_neighbours);
  return std::hypot(white, RoundingNoise(signal, kSteps));
}

std::vector<double> TimesOfSamples(std::span<const double> time_s, std::span<const double> torque,
                                   std::span<const double> angle) {
  // Of the product of both noises. By chance, two clocks that fit alike differ by a few per cent in some
  // hundred samples.
  constexpr double kSmoother = 0.9;
  std::vector<double> times_s(time_s.begin(), time_s.end());
  if (time_s.size() < 2) return times_s;
  std::vector<double> even_s = EvenTimes(time_s);
  const auto noise = [&](std::span<const double> at_s) {
    return SampleNoise(at_s, torque) * SampleNoise(at_s, angle);
  };
  return noise(even_s) < kSmoother * noise(time_s) ? even_s : times_s;
}

double FollowedShare(std::span<const double> time_s, std::span<const double> drive,
                     std::span<const double> clean_drive, std::span<const double> response, double slope) {
  const std::vector<double> x = FourthDifferences(time_s, drive);
  const std::vector<double> y = FourthDifferences(time_s, response);
  const std::vector<double> motion = FourthDifferences(time_s, clean_drive);
  constexpr double kNoise = 5.0;
  const double noise = SampleNoise(time_s, drive);
  const double x_limit = kNoise * noise;
  const double y_limit = kNoise * SampleNoise(time_s, response);
  // The response goes round the corners of the drive whether or not it follows the noise.
  const double motion_limit = 0.5 * noise;
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::abs(x[i]) > x_limit || std::abs(y[i]) > y_limit || std::abs(motion[i]) > motion_limit) continue;
    xx += slope * slope * x[i] * x[i];
    xy += slope * x[i] * y[i];
    yy += y[i] * y[i];
    count += 1.0;
  }
  if (!(xx > 0.0) || count < 20.0) return 0.0;
  const double share = xy / xx;
  // Neighbouring fourth differences are not independent: as if one in three were.
  const double error = std::sqrt(3.0 * std::max(yy - share * xy, 0.0) / count / xx);
  return share > 4.0 * error ? std::clamp(share, 0.0, 1.0) : 0.0;
}

double LastingNoise(std::span<const double> time_s, std::span<const double> signal) {
  if (signal.size() < 40) return 0.0;
  struct Level {
    double lag;
    double variance;  // of a second difference over the lag, by that of white noise
    double weight;
  };
  std::vector<Level> levels;
  for (std::size_t lag = 1; lag <= 16 && 16 * lag < signal.size(); lag *= 2) {
    std::vector<double> differences;
    for (std::size_t i = 2 * lag; i < signal.size(); ++i) {
      // Off the line through the other two, as if the middle one were midway.
      const double span_s = time_s[i] - time_s[i - 2 * lag];
      const double share = span_s > 0.0 ? (time_s[i - lag] - time_s[i - 2 * lag]) / span_s : 0.5;
      const double off = std::lerp(signal[i - 2 * lag], signal[i], share) - signal[i - lag];
      differences.push_back(off * std::sqrt(6.0 / (1.0 + share * share + (1.0 - share) * (1.0 - share))));
    }
    const double deviation = RobustStandardDeviation(differences);
    if (!(deviation > 0.0)) return 0.0;
    levels.push_back({static_cast<double>(lag), deviation * deviation / 6.0, 1.0 / static_cast<double>(lag)});
  }
  // Of noise with lag-1 correlation ρ: 6 − 8 ρ^lag + 2 ρ^(2 lag), over 6. White unless autocorrelation
  // explains clearly more.
  const auto misfit_of = [&](double rho, double& variance) {
    double sum = 0.0;
    double weights = 0.0;
    for (const Level& level : levels) {
      const double correlation = std::pow(rho, level.lag);
      sum += level.weight *
             std::log(level.variance * 6.0 / (6.0 - 8.0 * correlation + 2.0 * correlation * correlation));
      weights += level.weight;
    }
    const double mean = sum / weights;
    variance = std::exp(mean);
    double misfit = 0.0;
    for (const Level& level : levels) {
      const double correlation = std::pow(rho, level.lag);
      const double off =
          std::log(level.variance * 6.0 / (6.0 - 8.0 * correlation + 2.0 * correlation * correlation)) - mean;
      misfit += level.weight * off * off;
    }
    return misfit;
  };
  double white = 0.0;
  const double without = misfit_of(0.0, white);
  double best = without;
  double variance = white;
  for (double rho = 0.1; rho < 0.94; rho += 0.05) {
    double there = 0.0;
    const double misfit = misfit_of(rho, there);
    if (misfit < best) {
      best = misfit;
      variance = there;
    }
  }
  // Curvature grows with the distance, too, but without end: autocorrelation has to make the levels agree.
  const double chance = 20.0 / static_cast<double>(signal.size());
  const bool autocorrelated = without > chance && best < 0.2 * without;
  return std::sqrt(autocorrelated ? variance : levels.front().variance);
}

}  // namespace strainwave::analysis::diagnosis
