// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "analysis/reliability/lifetimes.h"
#include "analysis/reliability/profile.h"

namespace strainwave::analysis::reliability {

/// Units that are watched until one time, as a share of the truth's cumulative hazard there, (t/η)^β.
struct Watched {
  double units{};
  double until_hazard{};  // infinite: until they fail
};

/// Mean and standard deviation of the signed roots of a Weibull law's parameters at the truth, from simulated
/// samples like the one at hand: a parametric bootstrap, of samples that end at a failure (type II) without
/// any parameter in it. Source: docs/sources.md#wong-2000 (standardised signed roots);
/// docs/sources.md#lawless-2003, section 5.1 (what does not depend on the parameters).
struct FewFailures {
  /// Ends with that failure of all units; 0: each unit ends as `watched` says.
  int last_failure{};
  std::vector<Watched> watched;
  int simulated{2000};
};

/// What a sample says of how it came about. Where the longest time is a failure's, and any unit was suspended
/// then or none at all, it ended at that failure; else units that failed would have been watched until the
/// longest time. Lives before or between times count as failures that are seen.
FewFailures FewFailuresOf(std::span<const Lifetime> lifetimes, double shape, double scale);

/// Of ln t_p. The same input gives the same bits.
RootMoments QuantileRoots(const FewFailures& of, double share_failed);
/// Of ln σ = −ln β.
RootMoments ShapeRoots(const FewFailures& of);

}  // namespace strainwave::analysis::reliability
