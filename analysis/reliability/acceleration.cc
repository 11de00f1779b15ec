// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/acceleration.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/LU>

#include "analysis/reliability/weibull_likelihood.h"

namespace strainwave::analysis::reliability {
namespace {

using Eigen::Index, Eigen::VectorXd;

double LogFactor(const StressStep& step, const std::vector<double>& exponents) {
  double log = 0.0;
  for (std::size_t j = 0; j < exponents.size(); ++j) log += exponents[j] * step.log_stress[j];
  return log;
}

// τ of a unit's own time, and ln dτ/dt there.
struct Equivalent {
  double time{};
  double log_factor{};
};

Equivalent EquivalentOf(const StressedLife& life, double time, const std::vector<double>& exponents) {
  if (time == 0.0 || time == kNever) return {time, 0.0};
  Equivalent equivalent;
  double begin = 0.0;
  for (std::size_t k = 0; k < life.steps.size() && begin < time; ++k) {
    const bool last = k + 1 == life.steps.size();
    const double end = last ? time : std::min(life.steps[k].end, time);
    equivalent.log_factor = LogFactor(life.steps[k], exponents);
    equivalent.time += (end - begin) * std::exp(equivalent.log_factor);
    begin = end;
  }
  return equivalent;
}

// Coordinates: ln t_p at use, ln σ, then the exponents that are not fixed.
class Accelerated {
 public:
  Accelerated(std::span<const StressedLife> lives, const std::vector<ExponentPrior>& priors)
      : lives_(lives), priors_(priors) {
    for (std::size_t j = 0; j < priors.size(); ++j) {
      if (priors[j].deviation > 0.0) open_.push_back(j);
    }
  }

  Index size() const { return 2 + static_cast<Index>(open_.size()); }
  /// The coordinate of an exponent; −1: fixed.
  Index CoordinateOf(std::size_t exponent) const {
    const auto found = std::ranges::find(open_, exponent);
    return found == open_.end() ? -1 : 2 + (found - open_.begin());
  }

  std::vector<double> Exponents(const VectorXd& at) const {
    std::vector<double> exponents;
    for (const ExponentPrior& prior : priors_) exponents.push_back(prior.mean);
    for (std::size_t i = 0; i < open_.size(); ++i) exponents[open_[i]] = at(2 + static_cast<Index>(i));
    return exponents;
  }

  double Value(const VectorXd& at, double zeta) const {
    const std::vector<double> exponents = Exponents(at);
    double sum = 0.0;
    std::vector<Lifetime> equivalent;
    for (const StressedLife& one : lives_) {
      const Equivalent lower = EquivalentOf(one, one.life.lower, exponents);
      const Equivalent upper = EquivalentOf(one, one.life.upper, exponents);
      equivalent.push_back({lower.time, one.life.is_exact() ? lower.time : upper.time, one.life.count});
      if (one.life.is_exact()) sum += one.life.count * lower.log_factor;
    }
    for (const std::size_t j : open_) {
      const double off = (exponents[j] - priors_[j].mean) / priors_[j].deviation;
      if (std::isfinite(priors_[j].deviation)) sum -= 0.5 * off * off;
    }
    return sum + WeibullOfQuantile(equivalent, -std::expm1(-std::exp(zeta)))(at.head(2)).value;
  }

 private:
  std::span<const StressedLife> lives_;
  const std::vector<ExponentPrior>& priors_;
  std::vector<std::size_t> open_;
};

template <class Function>
BoundedEstimate BoundedBy(const LogLikelihood& function, const Maximum& maximum, Index coordinate,
                          double level, Function map) {
  BoundedEstimate bounded;
  const double at = maximum.at(coordinate);
  bounded.value = bounded.median_unbiased = map(at);
  const double half = NormalQuantile(0.5 * (1.0 + level)) *
                      std::sqrt((-maximum.evaluation.hessian).inverse()(coordinate, coordinate));
  const auto mapped = [&](double low, double high) {
    return Interval{std::min(map(low), map(high)), std::max(map(low), map(high))};
  };
  bounded.fisher = mapped(at - half, at + half);
  const Interval ratio = LikelihoodRatioInterval(function, maximum, coordinate, level);
  bounded.likelihood_ratio = bounded.corrected = mapped(ratio.low, ratio.high);
  return bounded;
}

}  // namespace

bool IsConstant(std::span<const StressedLife> lives, std::size_t stress) {
  const double first = lives.front().steps.front().log_stress[stress];
  return std::ranges::all_of(lives, [&](const StressedLife& life) {
    return std::ranges::all_of(
        life.steps, [&](const StressStep& step) { return std::abs(step.log_stress[stress] - first) < 1e-9; });
  });
}

AcceleratedFit FitAccelerated(std::span<const StressedLife> lives, const std::vector<ExponentPrior>& priors,
                              const std::vector<double>& shares_failed, double level,
                              const std::vector<std::string>& names) {
  for (std::size_t j = 0; j < priors.size(); ++j) {
    if (std::isinf(priors[j].deviation) && IsConstant(lives, j))
      throw NoEstimate(
          fmt::format("{} is the same in all steps of all units: its exponent cannot be fitted", names[j]),
          fmt::format("another {} of some units, or the catalogue's exponent", names[j]));
  }
  const Accelerated model(lives, priors);
  // A first guess: the law of the times that the means of the exponents make.
  VectorXd at = VectorXd::Zero(model.size());
  for (std::size_t j = 0; j < priors.size(); ++j) {
    if (const Index c = model.CoordinateOf(j); c >= 0) at(c) = priors[j].mean;
  }
  std::vector<Lifetime> guessed;
  for (const StressedLife& one : lives) {
    const std::vector<double> exponents = model.Exponents(at);
    const double lower = EquivalentOf(one, one.life.lower, exponents).time;
    guessed.push_back({lower, one.life.is_exact() ? lower : EquivalentOf(one, one.life.upper, exponents).time,
                       one.life.count});
  }
  const WeibullFit first = FitWeibull(guessed);
  AcceleratedFit fit;
  fit.counts = first.counts;
  const auto maximum_of = [&](double share, LogLikelihood& function) {
    const double zeta = ExtremeValueQuantile(share);
    function = ByDifferences([&model, zeta](const VectorXd& x) { return model.Value(x, zeta); });
    at(0) = std::log(WeibullQuantile(first.shape, first.scale, share));
    at(1) = -std::log(first.shape);
    auto maximum = Maximise(function, at);
    if (!maximum)
      throw NoEstimate("the likelihood of these times and stresses has no maximum",
                       "more units at different stresses, or the catalogue's exponents");
    return *maximum;
  };
  LogLikelihood function;
  for (const double share : shares_failed) {
    const Maximum maximum = maximum_of(share, function);
    fit.quantiles.push_back(BoundedBy(function, maximum, 0, level, [](double x) { return std::exp(x); }));
  }
  const Maximum maximum = maximum_of(-std::expm1(-1.0), function);
  fit.log_likelihood = maximum.evaluation.value;
  fit.shape = BoundedBy(function, maximum, 1, level, [](double x) { return std::exp(-x); });
  for (std::size_t j = 0; j < priors.size(); ++j) {
    const Index c = model.CoordinateOf(j);
    const double mean = priors[j].mean;
    fit.exponents.push_back(c >= 0 ? BoundedBy(function, maximum, c, level, [](double x) { return x; })
                                   : BoundedEstimate{mean, mean, {mean, mean}, {mean, mean}, {mean, mean}});
  }
  return fit;
}

}  // namespace strainwave::analysis::reliability
