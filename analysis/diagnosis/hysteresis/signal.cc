// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/signal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

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

// Parabola through samples of a growing stretch, seen from one place.
class GrowingParabola {
 public:
  void Add(double x, double y) {
    double power = 1.0;
    for (double& sum : x_) {
      sum += power;
      power *= x;
    }
    y_[0] += y;
    y_[1] += y * x;
    y_[2] += y * x * x;
  }

  struct Point {
    double value;
    double variance;  // over that of a sample
  };
  // Value at x = 0, by the cofactors of the normal matrix; none where the samples do not hold a parabola.
  std::optional<Point> AtZero() const {
    const double c0 = x_[2] * x_[4] - x_[3] * x_[3];
    const double c1 = x_[3] * x_[2] - x_[1] * x_[4];
    const double c2 = x_[1] * x_[3] - x_[2] * x_[2];
    const double determinant = x_[0] * c0 + x_[1] * c1 + x_[2] * c2;
    if (!(determinant > 1e-9 * x_[0] * x_[2] * x_[4])) return std::nullopt;
    return Point{(c0 * y_[0] + c1 * y_[1] + c2 * y_[2]) / determinant, c0 / determinant};
  }

 private:
  std::array<double, 5> x_{};
  std::array<double, 3> y_{};
};

constexpr std::size_t kLongest = 64;

// The longest stretch that may be used at `at`, to its left, its right or both, before the parabola leaves
// what shorter ones say.
GrowingParabola::Point LongestAgreeing(std::span<const double> t, std::span<const double> y, std::size_t at,
                                       double noise, bool left, bool right) {
  constexpr double kAgree = 2.0;  // standard errors
  GrowingParabola parabola;
  parabola.Add(0.0, y[at]);
  GrowingParabola::Point best{y[at], 1.0};
  double low = y[at] - kAgree * noise;
  double high = y[at] + kAgree * noise;
  const std::size_t before = left ? at : kLongest;
  const std::size_t after = right ? t.size() - 1 - at : kLongest;
  const std::size_t room = std::min({before, after, kLongest});
  const std::size_t nearest = std::max<std::size_t>(at, 1);
  const double scale = t[nearest] - t[nearest - 1] > 0.0 ? t[nearest] - t[nearest - 1] : 1.0;
  std::size_t next = left && right ? 2 : 4;
  for (std::size_t reach = 1; reach <= room; ++reach) {
    if (left) parabola.Add((t[at - reach] - t[at]) / scale, y[at - reach]);
    if (right) parabola.Add((t[at + reach] - t[at]) / scale, y[at + reach]);
    if (reach != next) continue;
    next = reach * 3 / 2;
    const auto point = parabola.AtZero();
    if (!point) break;
    const double error = kAgree * noise * std::sqrt(point->variance);
    low = std::max(low, point->value - error);
    high = std::min(high, point->value + error);
    if (low > high) break;
    if (point->variance < best.variance) best = *point;
  }
  return best;
}

double SlopeOf(std::span<const double> t, std::span<const double> x, std::size_t from, std::size_t to) {
  const double span_s = t[to] - t[from];
  return span_s > 0.0 ? (x[to] - x[from]) / span_s : 0.0;
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

// Samples after which a signal turns from one straight line into another, both as straight as the noise lets
// one see: a ramp that ends in a hold. By lines through as many samples on either side; of neighbours the one
// whose lines part most.
std::vector<std::size_t> Corners(std::span<const double> t, std::span<const double> y, double noise) {
  constexpr std::size_t kReach = 16;
  constexpr double kClear = 8.0;  // standard errors of the change of slope
  const auto count = static_cast<double>(kReach);
  const double straight = noise * (1.0 + 2.5 / std::sqrt(2.0 * count));
  std::vector<std::size_t> corners;
  std::size_t best = 0;
  std::size_t last_before = 0;  // the corner, where the lines meet
  double most = 0.0;
  for (std::size_t i = kReach - 1; i + kReach < t.size(); ++i) {
    const ShortLine left =
        LineThrough(t.subspan(i + 1 - kReach, kReach), y.subspan(i + 1 - kReach, kReach), t[i]);
    const ShortLine right = LineThrough(t.subspan(i + 1, kReach), y.subspan(i + 1, kReach), t[i + 1]);
    const double step_s = (t[i + kReach] - t[i + 1 - kReach]) / (2.0 * count - 1.0);
    const double error = noise / step_s * std::sqrt(24.0 / (count * count * count));
    const double change = std::abs(left.slope - right.slope) / error;
    if (left.misfit > straight || right.misfit > straight || change < kClear) continue;
    const double share = (right.at_end - right.slope * (t[i + 1] - t[i]) - left.at_end) /
                         (left.slope - right.slope) / (t[i + 1] - t[i]);
    if (!(share > -1.0 && share < 2.0)) continue;
    if (most > 0.0 && i > best + kReach / 2) {
      corners.push_back(last_before);
      most = 0.0;
    }
    if (change > most) {
      most = change;
      best = i;
      last_before = share < 0.0 ? i - 1 : share > 1.0 ? i + 1 : i;
    }
  }
  if (most > 0.0) corners.push_back(last_before);
  return corners;
}

// Corners and breaks in their order; of both at one place the break.
std::vector<std::size_t> WithBreaks(std::span<const std::size_t> corners,
                                    std::span<const std::size_t> breaks) {
  constexpr std::size_t kOnePlace = 4;
  std::vector<std::size_t> all(breaks.begin(), breaks.end());
  for (const std::size_t corner : corners) {
    const auto next = std::ranges::lower_bound(breaks, corner);
    const bool by_next = next != breaks.end() && *next - corner < kOnePlace;
    const bool by_last = next != breaks.begin() && corner - *std::prev(next) < kOnePlace;
    if (!by_next && !by_last) all.push_back(corner);
  }
  std::ranges::sort(all);
  return all;
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

std::vector<double> TimesOfSamples(std::span<const double> time_s, std::span<const double> signal) {
  constexpr double kSmoother = 0.8;
  std::vector<double> times_s(time_s.begin(), time_s.end());
  if (time_s.size() < 2) return times_s;
  std::vector<double> even_s(time_s.size());
  const double step_s = (time_s.back() - time_s.front()) / static_cast<double>(time_s.size() - 1);
  for (std::size_t i = 0; i < even_s.size(); ++i) {
    even_s[i] = time_s.front() + step_s * static_cast<double>(i);
  }
  const bool stamps_jitter = SampleNoise(even_s, signal) < kSmoother * SampleNoise(time_s, signal);
  return stamps_jitter ? even_s : times_s;
}

CleanSignal WithoutNoise(std::span<const double> time_s, std::span<const double> signal, double noise,
                         std::span<const std::size_t> breaks) {
  constexpr double kGap = 4.0;  // of a mean step: what happened within it no parabola tells
  CleanSignal clean{{signal.begin(), signal.end()}, std::vector<double>(signal.size(), noise)};
  const std::size_t n = signal.size();
  if (!(noise > 0.0) || n < 6) return clean;
  const double gap_s = kGap * (time_s[n - 1] - time_s[0]) / static_cast<double>(n - 1);
  const std::vector<std::size_t> corners = WithBreaks(Corners(time_s, signal, noise), breaks);
  auto corner = corners.begin();
  std::size_t first = 0;
  while (first < n) {
    std::size_t end = first + 1;
    while (end < n && time_s[end] - time_s[end - 1] < gap_s) {
      while (corner != corners.end() && *corner + 1 < end) ++corner;
      if (corner != corners.end() && *corner + 1 == end) break;
      ++end;
    }
    const auto times = time_s.subspan(first, end - first);
    const auto values = signal.subspan(first, end - first);
    for (std::size_t i = 0; i < values.size(); ++i) {
      GrowingParabola::Point best{values[i], 1.0};
      for (const auto& [left, right] : {std::pair{true, true}, {true, false}, {false, true}}) {
        const GrowingParabola::Point point = LongestAgreeing(times, values, i, noise, left, right);
        if (point.variance < best.variance) best = point;
      }
      clean.values[first + i] = best.value;
      clean.errors[first + i] = noise * std::sqrt(best.variance);
    }
    first = end;
  }
  return clean;
}

std::vector<std::size_t> LoneSpikes(std::span<const double> time_s, std::span<const double> signal,
                                    double noise) {
  constexpr double kBeyondNoise = 8.0;
  constexpr double kBeyondTurn = 3.0;
  std::vector<std::size_t> spikes;
  for (std::size_t i = 2; i + 2 < signal.size(); ++i) {
    // By time: beside a gap the mean of both neighbours is far off any ramp.
    const double span_s = time_s[i + 1] - time_s[i - 1];
    const double share = span_s > 0.0 ? (time_s[i] - time_s[i - 1]) / span_s : 0.5;
    const double off = std::abs(signal[i] - std::lerp(signal[i - 1], signal[i + 1], share));
    // On a riser of a stair the way past the sample is steep, and flat before and behind.
    const double before = SlopeOf(time_s, signal, i - 2, i - 1);
    const double past = SlopeOf(time_s, signal, i - 1, i + 1);
    const double behind = SlopeOf(time_s, signal, i + 1, i + 2);
    const auto [least, most] = std::minmax({before, past, behind});
    const double turn = 0.5 * span_s * (most - least);
    if (off > kBeyondNoise * noise && off > kBeyondTurn * turn && off > 0.0) spikes.push_back(i);
  }
  return spikes;
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

std::vector<Turn> FindTurns(std::span<const double> time_s, std::span<const double> signal, double noise) {
  constexpr std::size_t kReach = 5;
  constexpr std::size_t kLongestReach = 80;
  constexpr double kSharp = 4.0;
  constexpr double kStraight = 0.03;  // of the turn
  const std::size_t n = signal.size();
  std::vector<Turn> turns;
  if (n < 2 * kReach + 2) return turns;
  const double mean_step_s = (time_s[n - 1] - time_s[0]) / static_cast<double>(n - 1);
  for (std::size_t i = kReach; i + kReach < n; ++i) {
    const double step_s = time_s[i + 1] - time_s[i];
    // Over a gap lines from a few samples would be off by more than the noise: as many as the gap lasts, as
    // far as the signal is straight there.
    const double gap = std::min(step_s / std::max(mean_step_s, 1e-300), static_cast<double>(kLongestReach));
    std::size_t reach = std::max(kReach, static_cast<std::size_t>(gap));
    for (;; reach = std::max(kReach, reach / 2)) {
      const std::size_t before = std::min(reach, i + 1);
      const std::size_t after = std::min(reach, n - i - 1);
      const ShortLine left = LineThrough(time_s.subspan(i + 1 - before, before),
                                         signal.subspan(i + 1 - before, before), time_s[i]);
      const ShortLine right =
          LineThrough(time_s.subspan(i + 1, after), signal.subspan(i + 1, after), time_s[i + 1]);
      const double turn = std::abs(left.slope - right.slope) * step_s;
      const double allowed = 2.0 * noise + kStraight * turn;
      if (left.misfit <= allowed && right.misfit <= allowed) {
        if (!(turn > kSharp * noise) || !(turn > 0.0)) break;
        const double share =
            (right.at_end - right.slope * step_s - left.at_end) / (left.slope - right.slope) / step_s;
        if (share > 0.0 && share < 1.0)
          turns.push_back({i, share, left.at_end + left.slope * share * step_s});
        break;
      }
      if (reach == kReach) break;
    }
  }
  return turns;
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
