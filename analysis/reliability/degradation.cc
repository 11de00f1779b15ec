// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/degradation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/LU>

#include "analysis/reliability/straight_fit.h"

namespace strainwave::analysis::reliability {
namespace {

using Eigen::VectorXd;

constexpr std::size_t kMostPoints = 80;
constexpr double kSmallestPower = 0.3;
constexpr double kLargestPower = 4.0;

template <class Value>
double SmallestPower(Value value) {
  constexpr int kSteps = 37;
  double best = kSmallestPower;
  double smallest = kNever;
  const double step = (kLargestPower - kSmallestPower) / kSteps;
  for (int i = 0; i <= kSteps; ++i) {
    const double power = kSmallestPower + step * i;
    const double v = value(power);
    if (v < smallest) {
      smallest = v;
      best = power;
    }
  }
  double low = std::max(kSmallestPower, best - step);
  double high = std::min(kLargestPower, best + step);
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  for (int i = 0; i < 30; ++i) {
    const double a = high - golden * (high - low);
    const double b = low + golden * (high - low);
    value(a) < value(b) ? high = b : low = a;
  }
  return 0.5 * (low + high);
}

// ln ∫ exp(−(e^u − slope)² / (2 variance)) N(u; mean, deviation) du, about its mode.
double LogIntegral(double slope, double variance, double mean, double deviation) {
  const auto log_at = [&](double u) {
    const double off = std::exp(u) - slope;
    const double z = (u - mean) / deviation;
    return -0.5 * off * off / variance - 0.5 * z * z;
  };
  double u = slope > 0.0 && variance < slope * slope * deviation * deviation ? std::log(slope) : mean;
  double curvature = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double b = std::exp(u);
    const double gradient = -(b - slope) * b / variance - (u - mean) / (deviation * deviation);
    curvature = std::max(b * b / variance, 0.0) + 1.0 / (deviation * deviation);
    double step = std::clamp(gradient / curvature, -1.0, 1.0);
    while (std::abs(step) > 1e-14 && log_at(u + step) < log_at(u)) step *= 0.5;
    u += step;
    if (std::abs(step) < 1e-9) break;
  }
  // A trapezium over a Gaussian shape is exact to rounding once its steps are shorter than its width.
  const double width = 1.0 / std::sqrt(curvature);
  const double peak = log_at(u);
  double sum = 0.0;
  constexpr int kHalf = 24;
  constexpr double kReach = 8.0;
  for (int i = -kHalf; i <= kHalf; ++i) sum += std::exp(log_at(u + kReach * width * i / kHalf) - peak);
  return peak + std::log(sum * kReach * width / kHalf / (deviation * std::sqrt(2.0 * std::numbers::pi)));
}

// Of all paths at one κ: pooled noise and the log-likelihood of ln b ~ N(mean, deviation).
class Population {
 public:
  Population(std::span<const DegradationPath> paths, double reference) {
    for (const DegradationPath& path : paths) {
      DegradationPath scaled = Binned(path, kMostPoints);
      for (double& cycle : scaled.cycle) cycle /= reference;
      paths_.push_back(std::move(scaled));
    }
  }

  double Value(double log_quantile, double log_deviation, double power, double z) const {
    if (!(power >= kSmallestPower && power <= kLargestPower && std::abs(log_deviation) < 12.0))
      return -kNever;
    const double deviation = std::exp(log_deviation);
    const double mean = deviation * z - power * log_quantile;
    double residuals = 0.0;
    double freedom = 0.0;
    std::vector<StraightFit> fits;
    for (const DegradationPath& path : paths_) {
      fits.push_back(FitPower(path.cycle, path.way, power));
      residuals += fits.back().residual_sum;
      freedom += static_cast<double>(path.cycle.size()) - 2.0;
    }
    const double variance = residuals / freedom;
    double sum = -0.5 * residuals / variance;
    for (std::size_t i = 0; i < fits.size(); ++i) {
      sum -= 0.5 * (static_cast<double>(paths_[i].cycle.size()) - 1.0) * std::log(variance);
      sum += LogIntegral(fits[i].slope, variance * fits[i].slope_spread, mean, deviation);
    }
    return sum;
  }

  double ResidualSum(double power) const {
    double sum = 0.0;
    for (const DegradationPath& path : paths_) sum += FitPower(path.cycle, path.way, power).residual_sum;
    return sum;
  }

  const std::vector<DegradationPath>& paths() const { return paths_; }

 private:
  std::vector<DegradationPath> paths_;
};

}  // namespace

DegradationLife LifeFromDegradation(std::span<const DegradationPath> paths,
                                    const std::vector<double>& shares_failed, double level) {
  if (paths.size() < 2)
    throw NoEstimate("one specimen tells nothing of how others differ",
                     "two campaigns at least, of different specimens; its own forecast needs one");
  double reference = 0.0;
  for (const DegradationPath& path : paths) {
    RequirePath(path);
    reference = std::max(reference, path.cycle.back());
  }
  const Population population(paths, reference);
  const double power = SmallestPower([&](double k) { return population.ResidualSum(k); });
  DegradationLife life;
  double freedom = 0.0;
  std::vector<double> logs;
  for (const DegradationPath& path : population.paths()) {
    const StraightFit fit = FitPower(path.cycle, path.way, power);
    freedom += static_cast<double>(path.cycle.size()) - 2.0;
    if (fit.slope > 0.0) logs.push_back(std::log(fit.slope));
    life.pseudo_failures.push_back(
        fit.slope > 0.0 ? reference * std::pow(std::max(1.0 - fit.intercept, 0.0) / fit.slope, 1.0 / power)
                        : kNever);
  }
  if (logs.empty()) throw NoEstimate("no specimen approaches its limit", "more cycles, or another limit");
  life.noise = std::sqrt(population.ResidualSum(power) / freedom);
  double mean = 0.0;
  for (const double log : logs) mean += log / static_cast<double>(logs.size());
  double squares = 0.0;
  for (const double log : logs) squares += (log - mean) * (log - mean);
  const double deviation = std::max(std::sqrt(squares / static_cast<double>(logs.size())), 0.02);
  for (const double share : shares_failed) {
    const double z = NormalQuantile(share);
    const LogLikelihood function =
        ByDifferences([&](const VectorXd& at) { return population.Value(at(0), at(1), at(2), z); }, 1e-3);
    const Eigen::Vector3d start((deviation * z - mean) / power, std::log(deviation), power);
    const bool at_end = power < kSmallestPower + 0.02 || power > kLargestPower - 0.02;
    const auto maximum =
        Maximise(function, start, at_end ? std::vector<Eigen::Index>{2} : std::vector<Eigen::Index>{});
    if (!maximum)
      throw NoEstimate("the likelihood of these paths has no maximum",
                       "more cycles, or specimens that differ");
    const auto to_cycles = [&](double log) { return reference * std::exp(log); };
    BoundedEstimate bounded;
    bounded.value = bounded.median_unbiased = to_cycles(maximum->at(0));
    const double half =
        NormalQuantile(0.5 * (1.0 + level)) * std::sqrt((-maximum->evaluation.hessian).inverse()(0, 0));
    bounded.fisher = {to_cycles(maximum->at(0) - half), to_cycles(maximum->at(0) + half)};
    const Interval ratio = LikelihoodRatioInterval(function, *maximum, 0, level);
    bounded.likelihood_ratio = bounded.corrected = {to_cycles(ratio.low), to_cycles(ratio.high)};
    life.quantiles.push_back(bounded);
    life.power = maximum->at(2);
    life.log_slope_deviation = std::exp(maximum->at(1));
  }
  return life;
}

}  // namespace strainwave::analysis::reliability
