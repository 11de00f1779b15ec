// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/degradation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "analysis/reliability/limit_forecast.h"
#include "analysis/reliability/rate_trend.h"
#include "analysis/reliability/weibull_fit.h"

namespace strainwave::analysis::reliability {
namespace {

// Half-normal scale of the deviation of ln(life) between units: that of a maker whose L50 is five times L10
// (docs/sources.md#hd-csf-csg), ln 5 / 1.2816.
constexpr double kPriorDeviation = 1.256;

// With ten times and four times as many the ends of the intervals of six populations moved by 1 to 3 %.
constexpr std::size_t kSharedDraws = 200;
constexpr std::size_t kOwnDraws = 100;
constexpr double kLongest = 1e4;      // lives longer than so many times what was seen count as that
constexpr double kLeastError = 1e-3;  // of the logarithm of a life

using Wander = std::array<WanderStep, kFutureSteps>;

class Normals {
 public:
  Wander DrawWander() {
    Wander wander;
    for (WanderStep& step : wander) {
      step.exponent = normal_(random_);
      step.rate = normal_(random_);
    }
    return wander;
  }
  RateNow DrawFrom(const RateTrend& trend) { return trend.Draw(normal_, random_); }

 private:
  std::mt19937_64 random_{1};
  boost::random::normal_distribution<double> normal_;
};

// ln(life) as a draw of what is shared leaves it.
struct ForeseenLife {
  double mean{};
  double variance{};
};

ForeseenLife Summed(std::vector<double>& logs) {
  std::ranges::sort(logs);
  const auto at = [&](double share) {
    return logs[static_cast<std::size_t>(share * static_cast<double>(logs.size() - 1))];
  };
  const double error = std::max(0.5 * (at(0.8413) - at(0.1587)), kLeastError);
  return {at(0.5), error * error};
}

// A unit whose limit is to come.
class Approaching {
 public:
  Approaching(const RateTrend& trend, Normals& normals) : log_last_(std::log(trend.last_cycle())) {
    for (std::size_t i = 0; i < kOwnDraws; ++i) now_.push_back(normals.DrawFrom(trend));
  }

  ForeseenLife Given(const Wander& shared) const {
    std::vector<double> logs;
    for (const RateNow& now : now_) {
      const double crossing = CrossingOf(now, [&](std::size_t step) { return shared[step]; });
      logs.push_back(log_last_ + std::log(std::min(crossing, kLongest)));
    }
    return Summed(logs);
  }

 private:
  double log_last_;
  std::vector<RateNow> now_;
};

// What units tell of the normal law of ln(life).
struct Evidence {
  std::vector<ForeseenLife> lives;      // seen or forecast
  std::vector<double> suspended_after;  // ln(cycle)

  double LogLikelihood(double mean, double deviation) const {
    double sum = 0.0;
    for (const ForeseenLife& life : lives) {
      const double variance = deviation * deviation + life.variance;
      const double off = life.mean - mean;
      sum -= 0.5 * (off * off / variance + std::log(variance / life.variance));
    }
    for (const double after : suspended_after)
      sum += std::log(std::max(0.5 * std::erfc((after - mean) / (deviation * std::numbers::sqrt2)), 1e-300));
    return sum;
  }
};

struct Weighed {
  double mean{};
  double deviation{};
  double log_weight{};
};

// The posterior by quadrature: deviations by even ratios, means about that of the lives, fine near it and
// out to where so few lives leave any weight.
void AddPosterior(const Evidence& evidence, std::vector<Weighed>& points) {
  constexpr int kDeviations = 30;
  constexpr double kSmallest = 0.01;
  constexpr double kLargest = 4.0;
  constexpr int kHalf = 30;
  constexpr double kReach = 6.0;
  const auto n = static_cast<double>(evidence.lives.size());
  double centre = 0.0;
  for (const ForeseenLife& life : evidence.lives) centre += life.mean / n;
  double square = 0.0;
  for (const ForeseenLife& life : evidence.lives)
    square += ((life.mean - centre) * (life.mean - centre) + life.variance) / n;
  const double width = std::sqrt(square / n);
  const double end = std::asinh(kReach / width);
  const std::size_t begin = points.size();
  for (int i = 0; i < kDeviations; ++i) {
    const double deviation = kSmallest * std::pow(kLargest / kSmallest, (i + 0.5) / kDeviations);
    const double z = deviation / kPriorDeviation;
    for (int k = -kHalf; k <= kHalf; ++k) {
      const double t = end * k / kHalf;
      const double mean = centre + width * std::sinh(t);
      // Of even steps of t and of ln(deviation).
      const double measure = std::log(std::cosh(t)) + std::log(width * deviation * end);
      points.push_back({mean, deviation, evidence.LogLikelihood(mean, deviation) - 0.5 * z * z + measure});
    }
  }
  // Every draw of what is shared weighs the same: what specimens have shown tells nothing of what comes.
  double most = -kNever;
  for (std::size_t i = begin; i < points.size(); ++i) most = std::max(most, points[i].log_weight);
  double sum = 0.0;
  for (std::size_t i = begin; i < points.size(); ++i) sum += std::exp(points[i].log_weight - most);
  for (std::size_t i = begin; i < points.size(); ++i) points[i].log_weight -= most + std::log(sum);
}

// Quantiles of a function of the points, at ascending shares.
template <class Value>
LifeQuantile QuantileOf(const std::vector<Weighed>& points, double level, Value value) {
  std::vector<std::pair<double, double>> weights;
  weights.reserve(points.size());
  double sum = 0.0;
  for (const Weighed& point : points) {
    const double weight = std::exp(point.log_weight);
    weights.emplace_back(value(point), weight);
    sum += weight;
  }
  std::ranges::sort(weights);
  LifeQuantile quantile;
  double below = 0.0;
  const std::array<std::pair<double, double*>, 3> wanted{{{0.5 * (1.0 - level), &quantile.interval.low},
                                                          {0.5, &quantile.value},
                                                          {0.5 * (1.0 + level), &quantile.interval.high}}};
  std::size_t next = 0;
  for (const auto& [at, weight] : weights) {
    below += weight;
    while (next < wanted.size() && below >= wanted[next].first * sum) *wanted[next++].second = at;
  }
  return quantile;
}

}  // namespace

DegradationLife LifeFromDegradation(std::span<const DegradationPath> paths,
                                    const std::vector<double>& shares_failed, double level) {
  if (paths.size() < 2)
    throw NoEstimate("one specimen tells nothing of how others differ",
                     "two campaigns at least, of different specimens; its own forecast needs one");
  DegradationLife life;
  Evidence known;
  std::vector<Approaching> approaching;
  Normals normals;
  for (const DegradationPath& path : paths) {
    RequirePath(path);
    const auto met = std::ranges::find_if(path.way, [](double way) { return way >= 1.0; });
    if (met != path.way.end()) {
      const double cycle = path.cycle[static_cast<std::size_t>(met - path.way.begin())];
      known.lives.push_back({std::log(cycle), kLeastError * kLeastError});
      life.pseudo_failures.push_back(cycle);
      continue;
    }
    const RateTrend trend(path);
    const LimitForecast forecast = ForecastLimit(trend, level);
    life.pseudo_failures.push_back(forecast.is_approached ? forecast.cycle : kNever);
    if (forecast.is_approached)
      approaching.emplace_back(trend, normals);
    else
      known.suspended_after.push_back(std::log(trend.last_cycle()));
  }
  if (known.lives.empty() && approaching.empty())
    throw NoEstimate("no specimen approaches its limit", "more cycles, or another limit");

  std::vector<Weighed> points;
  for (std::size_t draw = 0; draw < (approaching.empty() ? 1 : kSharedDraws); ++draw) {
    const Wander shared = normals.DrawWander();
    Evidence evidence = known;
    for (const Approaching& unit : approaching) evidence.lives.push_back(unit.Given(shared));
    AddPosterior(evidence, points);
  }
  double most = -kNever;
  for (const Weighed& point : points) most = std::max(most, point.log_weight);
  for (Weighed& point : points) point.log_weight -= most;
  constexpr double kNoWeight = -25.0;  // e^−25 of half a million points is less than 1e-5 of the whole
  std::erase_if(points, [](const Weighed& point) { return point.log_weight < kNoWeight; });

  life.log_deviation = QuantileOf(points, level, [](const Weighed& point) { return point.deviation; });
  for (const double share : shares_failed) {
    const double z = NormalQuantile(share);
    life.quantiles.push_back(QuantileOf(
        points, level, [&](const Weighed& point) { return std::exp(point.mean + z * point.deviation); }));
  }
  return life;
}

}  // namespace strainwave::analysis::reliability
