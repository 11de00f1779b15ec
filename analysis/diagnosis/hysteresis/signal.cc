// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/signal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

namespace strainwave::analysis::diagnosis {
namespace {

// Parabola through samples of a growing segment, seen from one point.
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

// The longest segment that may be used at `at`, to its left, its right or both, before the parabola leaves
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

// Corners and breaks in their order; of both at one sample the break.
std::vector<std::size_t> WithBreaks(std::span<const std::size_t> corners,
                                    std::span<const std::size_t> breaks) {
  constexpr std::size_t kSameSample = 4;
  std::vector<std::size_t> all(breaks.begin(), breaks.end());
  for (const std::size_t corner : corners) {
    const auto next = std::ranges::lower_bound(breaks, corner);
    const bool by_next = next != breaks.end() && *next - corner < kSameSample;
    const bool by_last = next != breaks.begin() && corner - *std::prev(next) < kSameSample;
    if (!by_next && !by_last) all.push_back(corner);
  }
  std::ranges::sort(all);
  return all;
}

// First samples of the pieces between gaps, corners and breaks, and the number of samples.
std::vector<std::size_t> PiecesOf(std::span<const double> time_s, std::span<const double> signal,
                                  double noise, std::span<const std::size_t> breaks) {
  constexpr double kNothingBeside = 4.0;  // of a mean step: what happened within it nothing beside it tells
  const std::size_t n = signal.size();
  const double gap_s = kNothingBeside * (time_s[n - 1] - time_s[0]) / static_cast<double>(n - 1);
  const std::vector<std::size_t> corners = WithBreaks(Corners(time_s, signal, noise), breaks);
  auto corner = corners.begin();
  std::vector<std::size_t> pieces{0};
  for (std::size_t i = 1; i < n; ++i) {
    while (corner != corners.end() && *corner + 1 < i) ++corner;
    if (time_s[i] - time_s[i - 1] >= gap_s || (corner != corners.end() && *corner + 1 == i))
      pieces.push_back(i);
  }
  pieces.push_back(n);
  return pieces;
}

}  // namespace

CleanSignal WithoutNoise(std::span<const double> time_s, std::span<const double> signal, double noise,
                         std::span<const std::size_t> breaks) {
  CleanSignal clean{{signal.begin(), signal.end()}, std::vector<double>(signal.size(), noise)};
  const std::size_t n = signal.size();
  if (!(noise > 0.0) || n < 6) return clean;
  const std::vector<std::size_t> pieces = PiecesOf(time_s, signal, noise, breaks);
  for (std::size_t piece = 0; piece + 1 < pieces.size(); ++piece) {
    const std::size_t first = pieces[piece];
    const std::size_t end = pieces[piece + 1];
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
  }
  return clean;
}

std::vector<double> SlopesWithoutNoise(std::span<const double> time_s, std::span<const double> signal,
                                       double noise, std::span<const std::size_t> breaks) {
  constexpr double kError = 0.05;  // of the usual slope
  constexpr double kLongest = 200.0;
  const std::size_t n = signal.size();
  std::vector<double> slopes(n, 0.0);
  if (n < 2) return slopes;
  constexpr std::size_t kApart = 16;  // samples over which a ramp shows above its noise
  double square_sum = 0.0;
  for (std::size_t i = kApart; i < n; ++i)
    square_sum += std::pow((signal[i] - signal[i - kApart]) / static_cast<double>(kApart), 2.0);
  // Root mean square: of a signal that stands still for the most part it is still that of its ramps.
  const double usual_step = n > kApart ? std::sqrt(square_sum / static_cast<double>(n - kApart)) : 0.0;
  // Error of a line's slope through w samples: √12 / w^1.5 of the noise over a step.
  const double asked = std::cbrt(12.0 * std::pow(noise / (kError * std::max(usual_step, 1e-300)), 2.0));
  const auto window = static_cast<std::size_t>(std::clamp(std::ceil(asked), 2.0, kLongest));
  const std::vector<std::size_t> pieces = PiecesOf(time_s, signal, noise, breaks);
  for (std::size_t piece = 0; piece + 1 < pieces.size(); ++piece) {
    const std::size_t first = pieces[piece];
    const std::size_t end = pieces[piece + 1];
    const std::size_t inside = std::min(window, end - first);
    for (std::size_t i = first; i < end && inside > 1; ++i) {
      const std::size_t begin = std::clamp(i, first + inside / 2, end - inside + inside / 2) - inside / 2;
      slopes[i] = LineThrough(time_s.subspan(begin, inside), signal.subspan(begin, inside), 0.0).slope;
    }
  }
  // The way over a break is partly of either side; a piece of one sample has no slope of its own.
  for (std::size_t piece = 1; piece + 1 < pieces.size(); ++piece) {
    const std::size_t first = pieces[piece];
    const double own = SlopeOf(time_s, signal, first - 1, first);
    const auto [least, most] = std::minmax({slopes[first - 1], slopes[first]});
    slopes[first] = pieces[piece + 1] - first > 1 ? std::clamp(own, least, most) : own;
  }
  return slopes;
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

}  // namespace strainwave::analysis::diagnosis
