// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis_signal.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/noise_level.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Variance of 1 −4 6 −4 1 under white noise.
constexpr double kFourthDifference = 70.0;

std::vector<double> FourthDifferences(std::span<const double> x) {
  std::vector<double> differences;
  for (std::size_t i = 4; i < x.size(); ++i) {
    differences.push_back(x[i] - 4.0 * x[i - 1] + 6.0 * x[i - 2] - 4.0 * x[i - 3] + x[i - 4]);
  }
  return differences;
}

// Sums for straight lines over any stretch, from the record's start.
class LineSums {
 public:
  LineSums(std::span<const double> t, std::span<const double> y) : t_(t), sums_(t.size() + 1) {
    for (std::size_t i = 0; i < t.size(); ++i) {
      const double x = t[i] - t[0];
      const Sums& s = sums_[i];
      sums_[i + 1] = {s.x + x, s.xx + x * x, s.y + y[i], s.xy + x * y[i]};
    }
  }

  struct Point {
    double value;
    double variance;  // over that of a sample
  };
  // Value at sample `at` of the line through samples first..last.
  Point At(std::size_t at, std::size_t first, std::size_t last) const {
    const auto n = static_cast<double>(last - first + 1);
    const Sums& a = sums_[first];
    const Sums& b = sums_[last + 1];
    const double mean_x = (b.x - a.x) / n;
    const double mean_y = (b.y - a.y) / n;
    const double sxx = b.xx - a.xx - n * mean_x * mean_x;
    const double sxy = b.xy - a.xy - n * mean_x * mean_y;
    const double x = t_[at] - t_[0] - mean_x;
    if (!(sxx > 1e-9 * (1.0 + x * x))) return {mean_y, 1.0 / n};
    return {mean_y + sxy / sxx * x, 1.0 / n + x * x / sxx};
  }

 private:
  struct Sums {
    double x{}, xx{}, y{}, xy{};
  };
  std::span<const double> t_;
  std::vector<Sums> sums_;
};

constexpr std::size_t kLongest = 64;

// How far a line may reach from `at` to one side before its end value leaves what shorter lines say.
template <typename Stretch>
std::size_t Reach(double reading, double noise, std::size_t room, const Stretch& line) {
  constexpr double kAgree = 2.2;  // standard errors
  double low = reading - kAgree * noise;
  double high = reading + kAgree * noise;
  std::size_t reach = 0;
  for (std::size_t length = 2; length <= std::min(room, kLongest); length = length * 3 / 2 + 1) {
    const LineSums::Point point = line(length);
    const double error = kAgree * noise * std::sqrt(point.variance);
    low = std::max(low, point.value - error);
    high = std::min(high, point.value + error);
    if (low > high) break;
    reach = length;
  }
  return reach;
}

// Straight line through a few samples.
struct ShortLine {
  double at_end;  // value at the sample next to the gap
  double slope;
  double misfit;  // rms
};
ShortLine LineThrough(std::span<const double> t, std::span<const double> y, double end_s) {
  const auto n = static_cast<double>(t.size());
  double mean_t = 0.0;
  double mean_y = 0.0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    mean_t += t[i] / n;
    mean_y += y[i] / n;
  }
  double tt = 0.0;
  double ty = 0.0;
  double yy = 0.0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    tt += (t[i] - mean_t) * (t[i] - mean_t);
    ty += (t[i] - mean_t) * (y[i] - mean_y);
    yy += (y[i] - mean_y) * (y[i] - mean_y);
  }
  const double slope = tt > 0.0 ? ty / tt : 0.0;
  return {mean_y + slope * (end_s - mean_t), slope, std::sqrt(std::max(0.0, yy - slope * ty) / n)};
}

}  // namespace

double SampleNoise(std::span<const double> signal) {
  if (signal.size() < 6) return 0.0;
  double deviation = RobustStandardDeviation(FourthDifferences(signal)) / std::sqrt(kFourthDifference);
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
  const bool stepped = repeated > signal.size() / 10 && std::isfinite(step);
  if (stepped) deviation = std::hypot(deviation, step / std::sqrt(12.0));
  return deviation;
}

std::vector<double> WithoutNoise(std::span<const double> time_s, std::span<const double> signal,
                                 double noise) {
  std::vector<double> clean(signal.begin(), signal.end());
  const std::size_t n = signal.size();
  if (!(noise > 0.0) || n < 6) return clean;
  const LineSums lines(time_s, signal);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t before =
        Reach(signal[i], noise, i, [&](std::size_t k) { return lines.At(i, i - k, i); });
    const std::size_t after =
        Reach(signal[i], noise, n - 1 - i, [&](std::size_t k) { return lines.At(i, i, i + k); });
    // Each side's line by its own weight: one line over both would cut a corner short.
    double sum = 0.0;
    double weights = 0.0;
    for (const auto& [first, last] : {std::pair{i - before, i}, std::pair{i, i + after}}) {
      if (first == last) continue;
      const LineSums::Point point = lines.At(i, first, last);
      sum += point.value / point.variance;
      weights += 1.0 / point.variance;
    }
    if (weights > 0.0) clean[i] = sum / weights;
  }
  return clean;
}

double FollowedShare(std::span<const double> drive, std::span<const double> response, double slope) {
  const std::vector<double> x = FourthDifferences(drive);
  const std::vector<double> y = FourthDifferences(response);
  const double x_limit = 5.0 * RobustStandardDeviation(x);
  const double y_limit = 5.0 * RobustStandardDeviation(y);
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::abs(x[i]) > x_limit || std::abs(y[i]) > y_limit) continue;
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

std::vector<Turn> FindTurns(std::span<const double> time_s, std::span<const double> signal, double noise) {
  constexpr std::size_t kReach = 5;
  constexpr double kSharp = 4.0;
  constexpr double kStraight = 0.03;  // of the turn
  std::vector<Turn> turns;
  for (std::size_t i = kReach; i + kReach < signal.size(); ++i) {
    const double step_s = time_s[i + 1] - time_s[i];
    const ShortLine left = LineThrough(time_s.subspan(i + 1 - kReach, kReach),
                                       signal.subspan(i + 1 - kReach, kReach), time_s[i]);
    const ShortLine right =
        LineThrough(time_s.subspan(i + 1, kReach), signal.subspan(i + 1, kReach), time_s[i + 1]);
    const double turn = std::abs(left.slope - right.slope) * step_s;
    const double allowed = 2.0 * noise + kStraight * turn;
    if (!(turn > kSharp * noise) || !(turn > 0.0) || left.misfit > allowed || right.misfit > allowed)
      continue;
    const double share =
        (right.at_end - right.slope * step_s - left.at_end) / (left.slope - right.slope) / step_s;
    if (share > 0.0 && share < 1.0) turns.push_back({i, share, left.at_end + left.slope * share * step_s});
  }
  return turns;
}

double LastingNoise(std::span<const double> signal) {
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
      differences.push_back(signal[i] - 2.0 * signal[i - lag] + signal[i - 2 * lag]);
    }
    const double deviation = RobustStandardDeviation(differences);
    if (!(deviation > 0.0)) return 0.0;
    levels.push_back({static_cast<double>(lag), deviation * deviation / 6.0, 1.0 / static_cast<double>(lag)});
  }
  // Of noise with lag-1 correlation ρ: 6 − 8 ρ^lag + 2 ρ^(2 lag), over 6. White unless memory explains
  // clearly more.
  const auto misfit_of = [&](double rho, double& variance) {
    double sum = 0.0;
    double weights = 0.0;
    for (const Level& level : levels) {
      const double memory = std::pow(rho, level.lag);
      sum += level.weight * std::log(level.variance * 6.0 / (6.0 - 8.0 * memory + 2.0 * memory * memory));
      weights += level.weight;
    }
    const double mean = sum / weights;
    variance = std::exp(mean);
    double misfit = 0.0;
    for (const Level& level : levels) {
      const double memory = std::pow(rho, level.lag);
      const double off = std::log(level.variance * 6.0 / (6.0 - 8.0 * memory + 2.0 * memory * memory)) - mean;
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
  // Curvature grows with the distance, too, but without end: memory has to make the levels agree.
  const double chance = 20.0 / static_cast<double>(signal.size());
  const bool remembers = without > chance && best < 0.2 * without;
  return std::sqrt(remembers ? variance : levels.front().variance);
}

}  // namespace strainwave::analysis::diagnosis
