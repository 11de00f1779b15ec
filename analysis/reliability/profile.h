// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include "analysis/reliability/maximise.h"

namespace strainwave::analysis::reliability {

/// A two-sided interval. An end that the data do not bound is −∞ or ∞ (0 or ∞ of a quantity above zero).
struct Interval {
  double low{};
  double high{};
};

/// Where a signed root, which falls along ψ through zero at `estimate`, takes a value: from there on by steps
/// of `step` and then between. ±∞ where it never does; the root gives nothing where there is no likelihood.
double SolveRoot(const std::function<std::optional<double>(double)>& root_at, double estimate, double step,
                 double root);

/// A point with the coordinate at another value, and the others likely to be near their best there.
using MoveCoordinate = std::function<Eigen::VectorXd(const Eigen::VectorXd& at, double psi)>;

/// √(2 (ℓ̂ − ℓ_p(ψ))) with the sign of ψ̂ − ψ, where ℓ_p is the likelihood at its largest with one
/// coordinate held at ψ: normal about zero with variance one as data become many.
/// Source: docs/sources.md#meeker-1998, appendix B.6.6; for few docs/sources.md#wong-2000.
class SignedRoots {
 public:
  /// @param maximum  of `function`.
  /// @param move  where to look from for the others when the coordinate moves on; without it, where they
  /// were.
  SignedRoots(const LogLikelihood& function, const Maximum& maximum, Eigen::Index coordinate,
              MoveCoordinate move = {});

  /// Nothing where the likelihood has no maximum there.
  std::optional<double> At(double psi);

  /// The ψ at which the root takes a value; ±∞ where it never does.
  double Solve(double root);

 private:
  const LogLikelihood& function_;
  Maximum maximum_;
  Eigen::Index coordinate_;
  MoveCoordinate move_;
  double standard_error_{};
  Eigen::VectorXd warm_;  // where the last profile was
};

/// By how much the signed root of few data is not standard normal; subtracted and divided by.
struct RootMoments {
  double mean{0.0};
  double deviation{1.0};
};

/// {ψ : |(r(ψ) − mean) / deviation| ≤ z}, z the normal quantile of (1 + level) / 2.
Interval LikelihoodRatioInterval(const LogLikelihood& function, const Maximum& maximum,
                                 Eigen::Index coordinate, double level, const RootMoments& moments = {},
                                 const MoveCoordinate& move = {});

/// Of the normal distribution, p in 0…1.
double NormalQuantile(double p);
double NormalCumulative(double x);

}  // namespace strainwave::analysis::reliability
