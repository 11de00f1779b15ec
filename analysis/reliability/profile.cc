// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/profile.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/tools/roots.hpp>

namespace strainwave::analysis::reliability {
namespace {

constexpr double kFarthest = 60.0;  // of a logarithm: beyond it nothing is a life
constexpr int kRootBits = 30;

double StandardErrorAt(const Maximum& maximum, Eigen::Index coordinate) {
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(-maximum.evaluation.hessian);
  const Eigen::VectorXd unit = Eigen::VectorXd::Unit(maximum.at.size(), coordinate);
  const double variance = ldlt.solve(unit)(coordinate);
  return std::isfinite(variance) && variance > 0.0 ? std::sqrt(variance) : 1.0;
}

}  // namespace

SignedRoots::SignedRoots(const LogLikelihood& function, const Maximum& maximum, Eigen::Index coordinate,
                         MoveCoordinate move)
    : function_(function),
      maximum_(maximum),
      coordinate_(coordinate),
      move_(std::move(move)),
      standard_error_(StandardErrorAt(maximum, coordinate)),
      warm_(maximum.at) {}

std::optional<double> SignedRoots::At(double psi) {
  for (const bool anew : {false, true}) {
    Eigen::VectorXd start = anew ? maximum_.at : warm_;
    if (move_) start = move_(start, psi);
    start(coordinate_) = psi;
    const std::optional<Maximum> profile = Maximise(function_, start, {coordinate_});
    if (!profile) continue;
    warm_ = profile->at;
    const double drop = std::max(0.0, 2.0 * (maximum_.evaluation.value - profile->evaluation.value));
    return std::copysign(std::sqrt(drop), maximum_.at(coordinate_) - psi);
  }
  return std::nullopt;
}

double SignedRoots::Solve(double root) {
  warm_ = maximum_.at;
  return SolveRoot([this](double psi) { return At(psi); }, maximum_.at(coordinate_), standard_error_, root);
}

double SolveRoot(const std::function<std::optional<double>(double)>& root_at, double estimate, double step,
                 double root) {
  if (root == 0.0) return estimate;
  // A positive root lies below the estimate.
  const double direction = root > 0.0 ? -1.0 : 1.0;
  const double never = direction * std::numeric_limits<double>::infinity();
  double inside = estimate;
  double inside_root = 0.0;
  double outside = estimate;
  double outside_root = 0.0;
  for (step *= std::abs(root);; step *= 1.3) {
    outside = inside + direction * std::min(step, 3.0);
    if (std::abs(outside - estimate) > kFarthest) return never;
    const std::optional<double> r = root_at(outside);
    if (!r) return never;
    outside_root = *r;
    if (std::abs(outside_root) >= std::abs(root)) break;
    inside = outside;
    inside_root = outside_root;
  }
  const auto miss = [&](double psi) { return root_at(psi).value_or(outside_root) - root; };
  std::uintmax_t most = 100;
  const bool down = outside < inside;
  const auto found = boost::math::tools::toms748_solve(
      miss, std::min(inside, outside), std::max(inside, outside), (down ? outside_root : inside_root) - root,
      (down ? inside_root : outside_root) - root, boost::math::tools::eps_tolerance<double>(kRootBits), most);
  return 0.5 * (found.first + found.second);
}

Interval LikelihoodRatioInterval(const LogLikelihood& function, const Maximum& maximum,
                                 Eigen::Index coordinate, double level, const RootMoments& moments,
                                 const MoveCoordinate& move) {
  const double z = NormalQuantile(0.5 * (1.0 + level));
  SignedRoots roots(function, maximum, coordinate, move);
  return {roots.Solve(moments.mean + z * moments.deviation),
          roots.Solve(moments.mean - z * moments.deviation)};
}

double NormalQuantile(double p) { return boost::math::quantile(boost::math::normal(), p); }
double NormalCumulative(double x) { return boost::math::cdf(boost::math::normal(), x); }

}  // namespace strainwave::analysis::reliability
