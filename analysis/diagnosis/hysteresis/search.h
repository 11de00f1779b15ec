// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>

#include <vector>

#include "analysis/diagnosis/hysteresis/model.h"

namespace strainwave::analysis::diagnosis {

struct NominalLocalMinima {
  Eigen::VectorXd best;
  /// Where the other fits ended best, with another yield twist; empty where all ended alike. An effect that
  /// the model lacks may make friction of itself: what it is shows from the other local minimum alone.
  Eigen::VectorXd other;
};

/// Numbers of the nominal model fitted to the records from starts that need no fit of the caller's. Turns of
/// the torque between samples are taken off the records where the angle does not show them.
NominalLocalMinima FindNominal(LoopRecords& records);

/// Fits a model to a grid where all but one effect have their numbers already, fitted without that one: the
/// effect's forms and nonlinear parameters are ranked by what they would take off the residual beside all
/// other numbers moving along, the best of them are fitted, and the best fit is returned.
/// @param x  numbers of the whole model; those of `effect` are not read.
LoopSolution FitWithNewEffect(const LoopRecords& records, const LoopModel& model, std::size_t effect,
                              const LoopGrid& grid, const Eigen::VectorXd& x);

/// n ln(cost) + k ln(n) + 2 ln(search locations): what a better fit has to pay for further numbers, or for a
/// form that is less likely.
double PenalisedCost(const LoopModel& model, const LoopGrid& grid, const LoopSolution& solution);

/// A fit of a model that a record may not be able to tell from the best one.
struct Alternative {
  Eigen::VectorXd numbers;
  double nonlinear_parameter_range{};  // of the effect's shape that it stands for, which was held; 0 where
                                       // all is free
};
/// The model with one effect in each of its forms that it does not have in `x`, and, for each form that is
/// not out of the question, with its shape held at values away from the best one.
std::vector<Alternative> FitAlternatives(const LoopRecords& records, const LoopModel& model,
                                         std::size_t effect, const LoopGrid& grid, const Eigen::VectorXd& x);

}  // namespace strainwave::analysis::diagnosis
