// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include <fmt/format.h>

#include "analysis/statistics/gaussian_process.h"

namespace strainwave::analysis::statistics {
namespace {

// Bounds of the search: of lengths over the range of a coordinate, and of σn² / σf².
constexpr double kShortest = 1e-3;
constexpr double kLongest = 1e3;
constexpr double kLeastRatio = 1e-8;
constexpr double kMostRatio = 1e4;
constexpr int kMostSteps = 60;
constexpr double kFlat = 1e-5;     // largest slope at an optimum
constexpr double kNoGain = 1e-10;  // of a step, over the likelihood

struct Box {
  Eigen::VectorXd low;
  Eigen::VectorXd high;

  Eigen::VectorXd Into(const Eigen::VectorXd& x) const { return x.cwiseMax(low).cwiseMin(high); }
  // Parts of a slope that a bound holds back.
  void Release(const Eigen::VectorXd& x, Eigen::VectorXd& slope) const {
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      if ((x(i) <= low(i) && slope(i) < 0.0) || (x(i) >= high(i) && slope(i) > 0.0)) slope(i) = 0.0;
    }
  }
};

struct Optimum {
  Eigen::VectorXd at;
  double value{-std::numeric_limits<double>::infinity()};
};

// Climbs by BFGS with a backtracking search along each step.
Optimum Climb(ProfileLikelihood& likelihood, const Box& box, const Eigen::VectorXd& start) {
  const Eigen::Index n = start.size();
  Optimum best{box.Into(start)};
  Eigen::VectorXd slope;
  best.value = likelihood.Compute(best.at, slope);
  if (!std::isfinite(best.value)) return best;
  Eigen::MatrixXd curvature = Eigen::MatrixXd::Identity(n, n);
  bool first = true;
  for (int step = 0; step < kMostSteps; ++step) {
    Eigen::VectorXd free_slope = slope;
    box.Release(best.at, free_slope);
    if (free_slope.cwiseAbs().maxCoeff() < kFlat) break;
    Eigen::VectorXd direction = curvature * free_slope;
    if (!(direction.dot(free_slope) > 0.0)) {
      curvature.setIdentity();
      direction = free_slope;
    }
    // A unit in each logarithm is a factor of e: no step goes further at once.
    const double longest = direction.cwiseAbs().maxCoeff();
    double share = std::min(1.0, (first ? 0.7 : 2.0) / longest);
    Eigen::VectorXd next;
    Eigen::VectorXd next_slope;
    double value = -std::numeric_limits<double>::infinity();
    for (int halving = 0; halving < 20; ++halving, share *= 0.35) {
      next = box.Into(best.at + share * direction);
      value = likelihood.Compute(next, next_slope);
      if (value >= best.value + 1e-4 * slope.dot(next - best.at)) break;
    }
    if (!(value > best.value)) break;
    const Eigen::VectorXd moved = next - best.at;
    const Eigen::VectorXd fell = slope - next_slope;  // of the negative: what BFGS takes for a gradient
    const double gain = value - best.value;
    const double product = moved.dot(fell);
    if (product > 1e-12) {
      if (first) curvature *= product / fell.squaredNorm();
      const double inverse = 1.0 / product;
      const Eigen::MatrixXd left = Eigen::MatrixXd::Identity(n, n) - inverse * moved * fell.transpose();
      curvature = left * curvature * left.transpose() + inverse * moved * moved.transpose();
      first = false;
    }
    best.at = next;
    best.value = value;
    slope = next_slope;
    if (gain < kNoGain * (1.0 + std::abs(value))) break;
  }
  return best;
}

}  // namespace

GaussianProcess FitGaussianProcess(const ReplicatedData& data, const GaussianProcessFitSettings& settings) {
  if (data.size() < 3.0)
    throw std::invalid_argument(fmt::format("{} measurements (expected 3 or more)", data.size()));
  const double spread = data.within + (data.means.array() - data.means.mean()).square().sum();
  if (!(spread > 0.0))
    throw std::invalid_argument("all measurements are the same (expected some that differ)");
  ProfileLikelihood likelihood(data, settings.mean, settings.one_length);
  const Eigen::Index count = likelihood.parameter_count();
  const Eigen::VectorXd range =
      (data.points.colwise().maxCoeff() - data.points.colwise().minCoeff()).transpose();
  Box box{Eigen::VectorXd(count), Eigen::VectorXd(count)};
  Eigen::VectorXd middle(count);
  for (Eigen::Index k = 0; k + 1 < count; ++k) {
    const double wide = settings.one_length ? range.maxCoeff() : range(k);
    const double unit = std::log(wide > 0.0 ? wide : 1.0);
    box.low(k) = unit + std::log(kShortest);
    box.high(k) = unit + std::log(kLongest);
    middle(k) = unit + std::log(0.5);
  }
  box.low(count - 1) = std::log(kLeastRatio);
  box.high(count - 1) = std::log(kMostRatio);
  middle(count - 1) = std::log(0.1);
  Optimum best = Climb(likelihood, box, middle);
  std::mt19937_64 engine(settings.seed);
  const auto even = [&engine] { return static_cast<double>(engine() >> 11U) * 0x1p-53; };
  for (int restart = 0; restart < settings.restarts; ++restart) {
    Eigen::VectorXd start = middle;
    for (Eigen::Index k = 0; k + 1 < count; ++k) start(k) += std::log(0.1) + even() * std::log(40.0);
    start(count - 1) = std::log(1e-4) + even() * std::log(1e4);
    const Optimum other = Climb(likelihood, box, start);
    if (other.value > best.value) best = other;
  }
  if (!std::isfinite(best.value))
    throw std::domain_error("the covariance of the measurements is singular (expected more noise)");
  Eigen::VectorXd slope;
  likelihood.Compute(best.at, slope);
  GaussianProcessParameters parameters;
  parameters.signal_variance = likelihood.signal_variance();
  parameters.noise_variance = parameters.signal_variance * std::exp(best.at(count - 1));
  parameters.length = Eigen::VectorXd(data.points.cols());
  for (Eigen::Index k = 0; k < data.points.cols(); ++k)
    parameters.length(k) = std::exp(best.at(settings.one_length ? 0 : k));
  return {data, std::move(parameters), settings.mean};
}

}  // namespace strainwave::analysis::statistics
