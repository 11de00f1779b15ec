// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <stdexcept>
#include <string>

#include "analysis/reliability/lifetimes.h"
#include "analysis/reliability/profile.h"

namespace strainwave::analysis::reliability {

/// The data cannot give what is asked, with what could in `expected`.
class NoEstimate : public std::domain_error {
 public:
  NoEstimate(const std::string& what, std::string expected);
  const std::string& expected() const { return expected_; }

 private:
  std::string expected_;
};

/// Maximum likelihood of R(t) = exp(−(t/η)^β).
struct WeibullFit {
  double shape{};  // β
  double scale{};  // η, in the unit of the times
  double log_likelihood{};
  double log_scale_variance{};  // of ln η; from the observed information
  double log_shape_variance{};  // of ln β
  double log_covariance{};      // of ln η with ln β
  LifetimeCounts counts;
};

/// @throws std::invalid_argument as `RequireLifetimes` does.
/// @throws NoEstimate if nothing failed, or the likelihood grows with the shape for ever: all failures may
/// lie at one time that no unit outlived.
WeibullFit FitWeibull(std::span<const Lifetime> lifetimes);

/// t_p, by which a share p has failed: B10 is t at p = 0.1. @param share_failed  in 0…1, both excluded.
double WeibullQuantile(double shape, double scale, double share_failed);
double WeibullSurvival(double shape, double scale, double time);

/// An estimate with its intervals at one level.
struct BoundedEstimate {
  double value{};             // of maximum likelihood
  double median_unbiased{};   // as often above the truth as below; the value where nothing is corrected
  Interval fisher;            // normal in the logarithm (of a survival: in ln(−ln R))
  Interval likelihood_ratio;  // by χ² with one degree of freedom
  Interval corrected;         // likelihood ratio, its signed root standardised for few failures
};

/// What of a fit has bounds.
struct WeibullBounds {
  BoundedEstimate shape;
  BoundedEstimate scale;
};

struct BoundsSettings {
  double level{0.9};  // two-sided; each end alone holds with (1 + level) / 2
  /// Up to this many failures signed roots are standardised, by this many simulated samples.
  double most_failures_to_correct{30.0};
  int simulated{2000};
  /// In the place of simulated ones, where the caller knows them.
  std::optional<RootMoments> few{};
};

WeibullBounds BoundsOf(const WeibullFit& fit, std::span<const Lifetime> lifetimes,
                       const BoundsSettings& settings);
BoundedEstimate BoundsOfQuantile(const WeibullFit& fit, std::span<const Lifetime> lifetimes,
                                 double share_failed, const BoundsSettings& settings);
BoundedEstimate BoundsOfSurvival(const WeibullFit& fit, std::span<const Lifetime> lifetimes, double time,
                                 const BoundsSettings& settings);

}  // namespace strainwave::analysis::reliability
