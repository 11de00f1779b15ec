// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

namespace strainwave::analysis::reliability {

/// What a test is to show of a Weibull law whose shape is known: that at most a share of units fails before a
/// life, with a confidence, if no more than some of those on test fail.
struct Demonstration {
  double share_failed{0.1};  // B10
  double life{};             // that B10 is at least, in any unit of time
  double confidence{0.9};
  double shape{};
  int failures_allowed{0};
};

/// How long each of n units is to run, in the unit of the life: B10 is shown where Σ_{i ≤ k} C(n, i) (1 −
/// R_T)^i R_T^(n − i) ≤ 1 − C with R_T = R^((T/t)^β). Without failures T = t (ln(1 − C) / (n ln R))^(1/β).
/// Source: docs/sources.md#meeker-1998, section 10.6; docs/sources.md#clopper-1934 (the bound of a share).
/// @throws std::invalid_argument for a share, confidence, life or shape out of its range, or fewer units than
/// one more than the failures allowed.
double TestTimeToShow(const Demonstration& wanted, int units);

/// The fewest units that show it where each runs for a time; none up to `most`.
std::optional<int> UnitsToShow(const Demonstration& wanted, double time, int most = 100000);

/// The life that n units of that time show.
double LifeShown(const Demonstration& wanted, int units, double time);

/// How often a test is passed where the truth has that life: the chance that at most k of n fail by the time.
double ChanceToPass(const Demonstration& wanted, int units, double time, double true_life);

}  // namespace strainwave::analysis::reliability
