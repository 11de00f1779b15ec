// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/rate_trend.h"

#include <ceres/tiny_solver.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <boost/random/normal_distribution.hpp>

#include "analysis/reliability/profile.h"
#include "analysis/reliability/straight_fit.h"

namespace strainwave::analysis::reliability {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

// Of the logarithm of the rate over the logarithm of cycles (docs/life.md#forecasts has the counts). Chosen
// on lives seen to 60 % whose wear is the simulated plant's, settles, or is a gamma process (80 each; σ 0.3
// to 0.7, τ 0.7 to 1.4, μ 0 to 1 were tried): of 90 % intervals 97, 92 and 90 % held.
constexpr double kRateWander = 0.7;         // σ per √u
constexpr double kExponentWander = 0.7;     // τ per √u
constexpr double kExponentGrowth = 0.5;     // μ: wear grows faster in the end
constexpr double kExponentDeviation = 1.0;  // of β before anything is seen
constexpr double kLevelWeight = 1e-4;       // of ln r before anything is seen: none that matters

constexpr std::size_t kMostPointsOfOne = 80;
constexpr int kKnots = 12;          // of each random walk
constexpr Eigen::Index kFixed = 3;  // way₀, ln r now, β now
constexpr Eigen::Index kParameters = kFixed + 2 * kKnots;
constexpr int kSteps = 120;           // of the integrals over what was seen
constexpr double kLargestLog = 40.0;  // of a rate, so that it has an exponential

// Integral from the first point on, by trapezia.
VectorXd IntegralOf(const VectorXd& values, const VectorXd& over) {
  VectorXd sum = VectorXd::Zero(values.size());
  for (Eigen::Index i = 1; i < values.size(); ++i)
    sum(i) = sum(i - 1) + 0.5 * (values(i) + values(i - 1)) * (over(i) - over(i - 1));
  return sum;
}

VectorXd Rates(const VectorXd& logs) {
  return logs.cwiseMax(-kLargestLog).cwiseMin(kLargestLog).array().exp();
}

// What was seen, over cycles as shares of the last.
class SeenPath {
 public:
  SeenPath(const VectorXd& cycle, const VectorXd& way) : way_(way) {
    const double first = std::log(cycle(0));
    std::vector<double> grid(cycle.begin(), cycle.end());
    for (int i = 0; i <= kSteps; ++i)
      grid.push_back(std::exp(first * (1.0 - static_cast<double>(i) / kSteps)));
    std::ranges::sort(grid);
    grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
    cycle_ = VectorXd::Map(grid.data(), static_cast<Eigen::Index>(grid.size()));
    for (const double at : cycle) at_.push_back(std::ranges::lower_bound(grid, at) - grid.begin());
    knot_ = -first / kKnots;
    const VectorXd log = cycle_.array().log();
    log_rate_ = MatrixXd::Zero(log.size(), kParameters);
    log_rate_.col(1).setOnes();
    log_rate_.col(2) = log;
    for (int k = 0; k < kKnots; ++k) {
      // A step of the walk within a knot's interval: all before it lies lower by that much.
      const double end = first + knot_ * (k + 1);
      const VectorXd before = ((end - log.array()) / knot_).cwiseMax(0.0).cwiseMin(1.0);
      const VectorXd sum = IntegralOf(before, log);
      log_rate_.col(kFixed + k) = -before;
      log_rate_.col(kFixed + kKnots + k) = (sum(sum.size() - 1) - sum.array()).matrix();
    }
    prior_ = VectorXd::Constant(kParameters, 1.0 / (kRateWander * kRateWander * knot_));
    prior_.tail(kKnots).setConstant(1.0 / (kExponentWander * kExponentWander * knot_));
    prior_.head(kFixed) << 0.0, kLevelWeight, 1.0 / (kExponentDeviation * kExponentDeviation);
    expected_ = VectorXd::Zero(kParameters);
    expected_.tail(kKnots).setConstant(kExponentGrowth * knot_);
  }

  Eigen::Index size() const { return way_.size(); }
  const VectorXd& prior() const { return prior_; }
  const VectorXd& expected() const { return expected_; }

  VectorXd Residuals(const VectorXd& at) const {
    const VectorXd sum = IntegralOf(Rates(log_rate_ * at), cycle_);
    VectorXd residuals(way_.size());
    for (Eigen::Index i = 0; i < way_.size(); ++i) residuals(i) = way_(i) - at(0) - sum(at_[i]);
    return residuals;
  }

  MatrixXd Jacobian(const VectorXd& at) const {
    const VectorXd rates = Rates(log_rate_ * at);
    MatrixXd jacobian(way_.size(), kParameters);
    jacobian.col(0).setOnes();
    for (Eigen::Index j = 1; j < kParameters; ++j) {
      const VectorXd sum = IntegralOf(rates.cwiseProduct(log_rate_.col(j)), cycle_);
      for (Eigen::Index i = 0; i < way_.size(); ++i) jacobian(i, j) = sum(at_[i]);
    }
    return jacobian;
  }

  const VectorXd& cycle() const { return cycle_; }
  const MatrixXd& log_rate() const { return log_rate_; }

 private:
  VectorXd way_;
  VectorXd cycle_;                // of the integrals
  std::vector<Eigen::Index> at_;  // where the points are among them
  MatrixXd log_rate_;             // what each parameter adds to ln r
  VectorXd prior_;                // 1/variance
  VectorXd expected_;
  double knot_{};
};

struct Posterior {
  VectorXd mode;
  MatrixXd precision;
  VectorXd residuals;
  double free_parameters{};  // as many as the points determine
};

// What was seen over its noise, then each parameter off what is expected over its deviation; as
// ceres::TinySolver asks for it.
class WeighedPath {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = kParameters };

  WeighedPath(const SeenPath& path, double variance)
      : path_(path), weight_(1.0 / std::sqrt(variance)), prior_(path.prior().cwiseSqrt()) {}

  int NumResiduals() const { return static_cast<int>(path_.size() + kParameters); }

  bool operator()(const double* parameters, double* residuals, double* jacobian) const {
    const VectorXd at = VectorXd::Map(parameters, kParameters);
    Eigen::Map<VectorXd> out(residuals, NumResiduals());
    out.head(path_.size()) = weight_ * path_.Residuals(at);
    out.tail(kParameters) = prior_.cwiseProduct(at - path_.expected());
    if (jacobian != nullptr) {
      Eigen::Map<MatrixXd> slopes(jacobian, NumResiduals(), kParameters);
      slopes.topRows(path_.size()) = -weight_ * path_.Jacobian(at);
      slopes.bottomRows(kParameters) = prior_.asDiagonal();
    }
    return true;
  }

 private:
  const SeenPath& path_;
  double weight_;
  VectorXd prior_;  // 1/deviation
};

Posterior MaximumOf(const SeenPath& path, double variance, const VectorXd& start) {
  constexpr int kIterations = 60;
  ceres::TinySolver<WeighedPath> solver;
  solver.options.max_num_iterations = kIterations;
  Eigen::Matrix<double, kParameters, 1> at = start;
  solver.Solve(WeighedPath(path, variance), &at);
  const MatrixXd jacobian = path.Jacobian(at);
  const MatrixXd told = jacobian.transpose() * jacobian / variance;
  Posterior posterior{at, told + MatrixXd(path.prior().asDiagonal()), path.Residuals(at), 0.0};
  posterior.free_parameters = posterior.precision.ldlt().solve(told).trace();
  return posterior;
}

// 1 for independent residuals, more where they repeat each other.
double InflationBy(const VectorXd& residuals) {
  constexpr double kMostCorrelation = 0.95;
  const Eigen::Index n = residuals.size();
  const double squares = residuals.squaredNorm();
  if (!(squares > 0.0)) return 1.0;
  const double r =
      std::clamp(residuals.head(n - 1).dot(residuals.tail(n - 1)) / squares, 0.0, kMostCorrelation);
  return (1.0 + r) / (1.0 - r);
}

// One step of the future, of u = ln(cycle).
struct FutureStep {
  double du{};
  double before{};  // cycles, as multiples of the last, at its ends
  double after{};
  double growth{};           // of the exponent
  double exponent_wander{};  // standard deviations
  double rate_wander{};
};

// Fine while the life doubles, coarse to ten thousand times what was seen.
std::array<FutureStep, kFutureSteps> FutureStepsOf() {
  constexpr double kFine = 0.025;
  constexpr double kFineEnd = 1.5;
  constexpr int kHalf = kFutureSteps / 2;
  std::array<FutureStep, kFutureSteps> steps{};
  double u = 0.0;
  for (int i = 0; i < 2 * kHalf; ++i) {
    const double next =
        i < kHalf ? kFine * (i + 1) : kFineEnd + (i + 1 - kHalf) * (std::log(1e4) - kFineEnd) / kHalf;
    const double du = next - u;
    steps[static_cast<std::size_t>(i)] = {du,
                                          std::exp(u),
                                          std::exp(next),
                                          kExponentGrowth * du,
                                          kExponentWander * std::sqrt(du),
                                          kRateWander * std::sqrt(du)};
    u = next;
  }
  return steps;
}

double RateOf(double log_rate) { return std::exp(std::clamp(log_rate, -kLargestLog, kLargestLog)); }

}  // namespace

RateTrend::RateTrend(const DegradationPath& path) {
  RequirePath(path);
  last_cycle_ = path.cycle.back();
  const DegradationPath points = Binned(path, kMostPointsOfOne);
  const auto n = static_cast<Eigen::Index>(points.cycle.size());
  const VectorXd cycle = VectorXd::Map(points.cycle.data(), n) / last_cycle_;
  const VectorXd way = VectorXd::Map(points.way.data(), n);
  const StraightFit line = FitPower({cycle.data(), points.cycle.size()}, points.way, 1.0);
  straight_slope_ = line.slope;
  if (!(line.slope > 0.0)) return;

  const SeenPath seen(cycle, way);
  VectorXd start = seen.expected();
  start.head(kFixed) << way(0), std::log(line.slope), 0.0;
  // The noise and the path in turn, from what neighbours differ by.
  constexpr double kLeastVariance = 1e-10;  // of the way: no reading is better than 1e-5 of it
  double variance = std::max(
      0.5 * (way.tail(n - 1) - way.head(n - 1)).squaredNorm() / static_cast<double>(n - 1), kLeastVariance);
  Posterior posterior;
  constexpr int kTurns = 4;
  for (int turn = 0; turn < kTurns; ++turn) {
    posterior = MaximumOf(seen, variance, turn == 0 ? start : posterior.mode);
    const double freedom = std::max(static_cast<double>(n) - posterior.free_parameters, 4.0);
    variance = std::max(posterior.residuals.squaredNorm() / freedom * InflationBy(posterior.residuals),
                        kLeastVariance);
  }
  posterior = MaximumOf(seen, variance, posterior.mode);
  slope_error_ = std::sqrt(variance * line.slope_spread);
  cycle_ = seen.cycle();
  log_rate_ = seen.log_rate();
  mode_ = posterior.mode;
  precision_.compute(posterior.precision);
}

bool RateTrend::IsApproached(double level) const {
  return straight_slope_ > 0.0 && straight_slope_ > NormalQuantile(level) * slope_error_;
}

RateNow RateTrend::Draw(boost::random::normal_distribution<double>& normal, std::mt19937_64& random) const {
  VectorXd z(kParameters);
  for (double& value : z) value = normal(random);
  const VectorXd at = mode_ + precision_.matrixU().solve(z);
  const VectorXd way = IntegralOf(Rates(log_rate_ * at), cycle_);
  return {at(0) + way(way.size() - 1), at(1), at(2)};
}

double CrossingOf(const RateNow& now, const std::function<WanderStep(std::size_t step)>& wander) {
  static const std::array kFuture = FutureStepsOf();
  if (now.way >= 1.0) return 1.0;
  double way = now.way;
  double log_rate = now.log_rate;
  double rate = RateOf(log_rate);
  double exponent = now.exponent;
  for (std::size_t i = 0; i < kFuture.size(); ++i) {
    const FutureStep& step = kFuture[i];
    const WanderStep random = wander(i);
    const double bend = step.growth + step.exponent_wander * random.exponent;
    log_rate += (exponent + 0.5 * bend) * step.du + step.rate_wander * random.rate;
    const double next_rate = RateOf(log_rate);
    const double cycles = step.after - step.before;
    const double added = 0.5 * cycles * (rate + next_rate);
    if (way + added >= 1.0) return step.before + cycles * (1.0 - way) / added;
    way += added;
    exponent += bend;
    rate = next_rate;
  }
  return kNever;
}

}  // namespace strainwave::analysis::reliability
