// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <Eigen/Core>

namespace strainwave::analysis::statistics {

/// What one group's data say of a quantity of one component, or of several (a vector): its errors are known.
struct GroupEstimate {
  Eigen::VectorXd value;       // d
  Eigen::MatrixXd covariance;  // d × d, positive definite
};

/// A quantity whose true value differs from group to group.
struct RandomEffects {
  Eigen::VectorXd mean;             // μ
  Eigen::MatrixXd mean_covariance;  // of the estimate of μ, at τ
  double mean_p{1.0};               // chance of a mean as far from zero where μ = 0; Fisher's F
  double tau{};                     // standard deviation between groups, of each component
  double tau_low{};                 // its 95 % interval
  double tau_high{};
  double tau_of_moments{};  // another estimate, which more programs have: DerSimonian & Laird's
  double q{};               // Cochran's Q
  int degrees_of_freedom{};
  double homogeneity_p{1.0};  // chance of a Q as large where all groups are alike
};

/// Estimates of n groups as random effects:
///
///   yᵢ = μ + bᵢ + eᵢ,  bᵢ ~ N(0, τ² I),  eᵢ ~ N(0, Vᵢ) with Vᵢ known,  i = 1 … n
///
/// Everything comes from the generalised Q, which falls with τ² and at the true one is χ² of d (n − 1)
/// degrees of freedom:
///
///   Q(τ²) = ∑ (yᵢ − μ̂)ᵀ (Vᵢ + τ² I)⁻¹ (yᵢ − μ̂),  μ̂ the mean with these weights
///
/// τ is where Q equals its expectation, the ends of the interval where it equals the quantiles 0.975 and
/// 0.025 (Q-profile); 0 where it is below them at τ = 0. An interval of 0 to 0 speaks of errors that were
/// given too large. The mean's distance from zero is an F of d and d (n − 1) degrees of freedom, which is
/// exact where errors are small beside τ; where they differ tenfold and τ is small it calls a mean of zero
/// away from it up to 13 times of 100 at 5 %.
///
/// @throws std::invalid_argument for fewer than two groups, sizes that differ, numbers that are not finite,
///   or a covariance that is not positive definite.
///
/// Source: docs/sources.md#viechtbauer-2007 (interval), #paule-1982 (τ), #dersimonian-1986 (moments; here of
/// vectors), #knapp-2003 (test of the mean).
RandomEffects FitRandomEffects(std::span<const GroupEstimate> groups);

/// The 95 % interval of τ to be expected of so many groups like those seen: of between-groups deviation
/// `tau` and errors of one standard deviation, in d components.
struct ExpectedInterval {
  double low{};
  double high{};
};
ExpectedInterval ExpectedTauInterval(double tau, double standard_error, int groups, int components);

/// Chance of a χ² at least as large.
double ChanceOfChiSquare(double chi_square, double degrees_of_freedom);

}  // namespace strainwave::analysis::statistics
