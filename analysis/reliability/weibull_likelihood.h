// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "analysis/reliability/lifetimes.h"
#include "analysis/reliability/maximise.h"

namespace strainwave::analysis::reliability {

/// Log-likelihood of a two-parameter Weibull law, R(t) = exp(−(t/η)^β), of lives that are exact, suspended,
/// known from the left or within an interval, with density per unit of time. In logarithms of time the law
/// has a location μ = ln η and a scale σ = 1/β, and times from 1 to 10⁹ are alike. Source:
/// docs/sources.md#meeker-1998, section 7.2 and eq. 2.18 (contributions by kind of censoring).
///
/// Coordinates: (location, ln σ), where the location is ln t_p of the life t_p that a share p fails before:
/// ln η = ln t_p − σ ln(−ln(1 − p)).
/// @param lifetimes  sound, as `RequireLifetimes` has it; kept by the function.
LogLikelihood WeibullOfQuantile(std::span<const Lifetime> lifetimes, double share_failed);

/// The same in (ζ, ln σ), where ζ = ln(−ln R(t)) = (ln t − ln η)/σ is of one time t.
LogLikelihood WeibullOfSurvival(std::span<const Lifetime> lifetimes, double time);

/// ln(−ln(1 − p)): where the standard smallest extreme value has its quantile.
double ExtremeValueQuantile(double share_failed);

}  // namespace strainwave::analysis::reliability
