// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "analysis/diagnosis/noise_likelihood.h"
#include "analysis/diagnosis/study.h"
#include "analysis/parallel_for.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {

/// Of lines over an angle that are looked for.
inline constexpr double kHighestOrderPerTurn = 1000.0;

/// A shape that a residual may have, at the best search location.
struct ResidualView {
  Eigen::MatrixXd columns;   // samples × coefficients
  int degrees_of_freedom{};  // coefficients that are free beside the residual's mean
  double search_locations{1.0};
  /// The location can be moved without a grid, which counts √(likelihood ratio / 2) times more (Baluev, MNRAS
  /// 385 (2008) 1279, eq. 6).
  bool continuous{};
  std::function<std::string(const Eigen::VectorXd& coefficients)> describe;

  double SearchLocations(double likelihood_ratio) const;
};

/// Best lines over angles and over time, windows, dependences on the other regressors; those over angles
/// first.
/// @param parallel  over the regressors
std::vector<ResidualView> ResidualViewsOf(const Study& study, std::span<const double> residual,
                                          std::span<const double> weights, const NoiseFit& noise,
                                          const ParallelFor& parallel = InTurn);

/// Means over bins of a regressor, and before them a straight line where it has more than two values.
void AddDependence(const Study& study, const Regressor& regressor, std::span<const double> weights,
                   std::vector<ResidualView>& views);

/// How many searches ResidualViewsOf makes.
std::size_t CountViews(const Study& study);

/// Orders per turn that an evenly stepped angle folds into one another: 2π / step, in the unit of orders; 0
/// where the steps are not even (deviations above 2 % of a step) or there are none.
double FoldingOrder(std::span<const double> angle_rad, std::span<const double> weights);

/// An angle whose values span more comes by the same places again.
inline constexpr double kTurnsOnce = 1.05 * kTwoPi;

/// Each angle within its turn, from 0 to 2π; a full turn less rounding is the start of the next one.
std::vector<double> WithinTurn(std::span<const double> angle_rad);

/// A regressor's title "output angle / deg" in two parts.
struct TitleParts {
  std::string quantity;
  std::string unit;
};
TitleParts SplitTitle(const Regressor& regressor);

/// "output turn" for output_angle, "turn of position" for position.
std::string TurnOf(const Regressor& regressor);

}  // namespace strainwave::analysis::diagnosis
