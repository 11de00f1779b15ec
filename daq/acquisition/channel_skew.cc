// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/channel_skew.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace strainwave::daq::acquisition {
namespace {

constexpr int kMostRefinements = 20;
constexpr double kRefinedToSamples = 1e-9;
constexpr double kUnknowns = 3;
constexpr int kSmoothing = 5;  // samples to each side
constexpr double kLeastEigenvalue = 1e-10;
constexpr double kNoSample = std::numeric_limits<double>::quiet_NaN();

void DemandSameLength(std::size_t first, std::size_t second) {
  if (first != second)
    throw std::invalid_argument(fmt::format("{} and {} values are not as many", first, second));
}

double HannWeight(int k) { return 1 + std::cos(std::numbers::pi * k / (kSmoothing + 1)); }

double Mean(std::span<const double> values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

// The cubic through the samples at -1, 0, 1, 2, and its slope, at 0 <= t <= 1.
struct Cubic {
  double value;
  double slope;
};
Cubic CubicAt(const double* around, double t) {
  const double a = around[0], b = around[1], c = around[2], d = around[3];
  const double p1 = c - a / 3 - b / 2 - d / 6;
  const double p2 = (a + c) / 2 - b;
  const double p3 = (d - a) / 6 + (b - c) / 2;
  return {b + t * (p1 + t * (p2 + t * p3)), p1 + t * (2 * p2 + 3 * t * p3)};
}

// `values` at the fractional index, or nothing where four samples do not surround it.
std::optional<Cubic> At(std::span<const double> values, double index) {
  const double whole = std::floor(index);
  if (!(whole >= 1) || whole + 2 >= static_cast<double>(values.size())) return std::nullopt;
  return CubicAt(values.data() + static_cast<std::size_t>(whole) - 1, index - whole);
}

// The lag in samples of `second` behind `first` with the highest correlation over the rows that all lags
// share.
std::optional<int> BestLag(std::span<const double> first, std::span<const double> second, int longest) {
  const auto margin = static_cast<std::size_t>(longest);
  const std::span<const double> kept = first.subspan(margin, first.size() - 2 * margin);
  const double mean = Mean(kept);
  std::optional<int> best;
  double highest = 0;
  for (int lag = -longest; lag <= longest; ++lag) {
    const int begin_index = longest + lag;
    const auto begin = static_cast<std::size_t>(begin_index);
    const std::span<const double> shifted = second.subspan(begin, kept.size());
    const double shifted_mean = Mean(shifted);
    double product = 0, power = 0;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      product += (kept[i] - mean) * (shifted[i] - shifted_mean);
      power += (shifted[i] - shifted_mean) * (shifted[i] - shifted_mean);
    }
    if (power > 0 && product / std::sqrt(power) > highest) {
      highest = product / std::sqrt(power);
      best = lag;
    }
  }
  return best;
}

// A weighted mean around each value. Noise from one sample to the next would pull the estimate towards the
// fraction of a sample at which interpolation smooths it most.
std::vector<double> Smoothed(std::span<const double> values) {
  std::vector<double> result(values.size());
  const double mean = Mean(values);
  double sum = 0;
  for (int k = -kSmoothing; k <= kSmoothing; ++k) sum += HannWeight(k);
  const auto last = static_cast<std::ptrdiff_t>(values.size()) - 1;
  for (std::ptrdiff_t i = 0; i <= last; ++i) {
    for (int k = -kSmoothing; k <= kSmoothing; ++k) {
      const auto at = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(i + k, 0, last));
      result[static_cast<std::size_t>(i)] += HannWeight(k) / sum * (values[at] - mean);
    }
  }
  return result;
}

// One step of least squares for second[i] = gain * first(i - delay) + offset, over the rows beyond the
// margin.
struct Refined {
  double delay_change{};  // samples
  double gain{};
  double information{};  // inverse of the variance of the delay in samples^2, for values of variance one
};
std::optional<Refined> Refine(std::span<const double> first, std::span<const double> second,
                              std::size_t margin, double delay, double gain) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t i = margin; i + margin < second.size(); ++i) {
    const std::optional<Cubic> at = At(first, static_cast<double>(i) - delay);
    if (!at) continue;
    const Eigen::Vector3d row(-gain * at->slope, at->value, 1.0);
    normal += row * row.transpose();
    right += row * second[i];
  }
  const Eigen::Vector3d scale = normal.diagonal().cwiseSqrt();
  if (!(scale.minCoeff() > 0)) return std::nullopt;
  const Eigen::Matrix3d scaled =
      scale.cwiseInverse().asDiagonal() * normal * scale.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scaled);
  // At a constant speed a delay and an offset of the angle look the same.
  if (!(eigen.eigenvalues()(0) > kLeastEigenvalue)) return std::nullopt;
  const Eigen::LDLT<Eigen::Matrix3d> solver(scaled);
  const Eigen::Vector3d x = solver.solve(right.cwiseQuotient(scale)).cwiseQuotient(scale);
  const Eigen::Vector3d unit = Eigen::Vector3d::UnitX();
  const double inverse = solver.solve(unit)(0);
  return Refined{x(0), x(1), scale(0) * scale(0) / inverse};
}

// Variance of a value of the second channel about the first one, both with their noise.
double VarianceAbout(std::span<const double> first, std::span<const double> second, std::size_t margin,
                     double delay, const Refined& fit) {
  double sum = 0, squares = 0, rows = 0;
  for (std::size_t i = margin; i + margin < second.size(); ++i) {
    const std::optional<Cubic> at = At(first, static_cast<double>(i) - delay);
    if (!at) continue;
    const double residual = second[i] - fit.gain * at->value;
    sum += residual;
    squares += residual * residual;
    rows += 1;
  }
  // Interpolation passes on only a part of the first channel's noise; the estimate has felt all of it.
  const double t = -delay - std::floor(-delay);
  double passed_on = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    std::array<double, 4> one{};
    one[k] = 1;
    passed_on += CubicAt(one.data(), t).value * CubicAt(one.data(), t).value;
  }
  return (squares - sum * sum / rows) / (rows - kUnknowns) * 2 / (1 + passed_on);
}

}  // namespace

std::optional<Skew> SkewByCorrelation(std::span<const double> first, std::span<const double> second,
                                      double rate_hz, double longest_skew_s) {
  DemandSameLength(first.size(), second.size());
  const auto longest = static_cast<int>(std::ceil(longest_skew_s * rate_hz)) + 1;
  if (!(longest > 0) || first.size() < 4 * static_cast<std::size_t>(longest)) {
    throw std::invalid_argument(
        fmt::format("{} values are not four times the longest skew, {} samples", first.size(), longest));
  }
  const std::optional<int> lag = BestLag(first, second, longest);
  if (!lag || std::abs(*lag) == longest) return std::nullopt;
  const std::vector<double> a = Smoothed(first), b = Smoothed(second);
  const auto margin = static_cast<std::size_t>(longest) + 2 + kSmoothing;
  double delay = *lag;
  double gain = 1;
  for (int i = 0; i < kMostRefinements; ++i) {
    const std::optional<Refined> refined = Refine(a, b, margin, delay, gain);
    if (!refined || !std::isfinite(refined->delay_change)) return std::nullopt;
    // Further than the neighbours of the best lag it cannot lie.
    delay = std::clamp(delay + refined->delay_change, *lag - 1.0, *lag + 1.0);
    gain = refined->gain;
    if (std::abs(refined->delay_change) < kRefinedToSamples || i + 1 == kMostRefinements) {
      const double variance = VarianceAbout(first, second, margin, delay, *refined);
      return Skew{delay / rate_hz, std::sqrt(variance / refined->information) / rate_hz};
    }
  }
  return std::nullopt;
}

std::optional<Skew> SkewByRegression(std::span<const double> speed_rad_per_s,
                                     std::span<const double> difference_rad) {
  DemandSameLength(speed_rad_per_s.size(), difference_rad.size());
  if (speed_rad_per_s.size() < 3) return std::nullopt;
  const double mean_speed = Mean(speed_rad_per_s), mean_difference = Mean(difference_rad);
  double spread = 0, product = 0;
  for (std::size_t i = 0; i < speed_rad_per_s.size(); ++i) {
    spread += (speed_rad_per_s[i] - mean_speed) * (speed_rad_per_s[i] - mean_speed);
    product += (speed_rad_per_s[i] - mean_speed) * (difference_rad[i] - mean_difference);
  }
  if (!(spread > 0) || !std::isfinite(product)) return std::nullopt;
  const double slope_s = product / spread;
  double left = 0;
  for (std::size_t i = 0; i < speed_rad_per_s.size(); ++i) {
    const double residual = difference_rad[i] - mean_difference - slope_s * (speed_rad_per_s[i] - mean_speed);
    left += residual * residual;
  }
  return Skew{-slope_s, std::sqrt(left / static_cast<double>(speed_rad_per_s.size() - 2) / spread)};
}

std::vector<double> ShiftInTime(std::span<const double> values, double rate_hz, double shift_s) {
  std::vector<double> shifted(values.size(), kNoSample);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (const std::optional<Cubic> at = At(values, static_cast<double>(i) + shift_s * rate_hz)) {
      shifted[i] = at->value;
    }
  }
  return shifted;
}

std::vector<double> OnTimeBase(std::span<const double> times_s, std::span<const double> values,
                               std::span<const double> wanted_s) {
  DemandSameLength(times_s.size(), values.size());
  if (std::adjacent_find(times_s.begin(), times_s.end(), [](double a, double b) { return !(a < b); }) !=
      times_s.end()) {
    throw std::invalid_argument("times_s does not rise");
  }
  std::vector<double> result(wanted_s.size(), kNoSample);
  for (std::size_t k = 0; k < wanted_s.size(); ++k) {
    const auto after = std::upper_bound(times_s.begin(), times_s.end(), wanted_s[k]);
    const auto i = after - times_s.begin();  // times_s[i - 1] <= wanted < times_s[i]
    if (i < 2 || i + 1 >= static_cast<std::ptrdiff_t>(times_s.size())) continue;
    double sum = 0;
    for (std::ptrdiff_t m = i - 2; m <= i + 1; ++m) {  // Lagrange
      double weight = 1;
      for (std::ptrdiff_t n = i - 2; n <= i + 1; ++n) {
        if (n != m)
          weight *= (wanted_s[k] - times_s[static_cast<std::size_t>(n)]) /
                    (times_s[static_cast<std::size_t>(m)] - times_s[static_cast<std::size_t>(n)]);
      }
      sum += weight * values[static_cast<std::size_t>(m)];
    }
    result[k] = sum;
  }
  return result;
}

}  // namespace strainwave::daq::acquisition
