// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <memory>
#include <span>
#include <vector>

#include "analysis/diagnosis/vibration/channel_fits.h"
#include "analysis/diagnosis/vibration/narrowband.h"
#include "analysis/diagnosis/vibration/projection.h"
#include "analysis/diagnosis/vibration/samples.h"
#include "analysis/diagnosis/vibration/terms.h"
#include "analysis/parallel_for.h"

namespace strainwave::analysis::diagnosis {

/// A set of terms, fitted: every channel has coefficients of its own, all share the nonlinear parameters.
struct VibrationSolution {
  struct Channel {
    ChannelFit fit;                   // columns: nominal, then the observable terms in their order
    std::vector<Eigen::Index> first;  // of each term's columns, −1 where it is not observable
    Eigen::MatrixXd follows_nonlinear_parameters;  // change of coefficients by nonlinear parameters; with
                                                   // NonlinearParameterCovariance() only
  };
  std::vector<VibrationTerm> terms;
  std::vector<Channel> channels;                                             // run by run
  std::vector<std::vector<std::shared_ptr<const Eigen::MatrixXd>>> columns;  // [run][term], unfiltered
  Eigen::VectorXd unexplained;  // what narrow-band terms predict from, all samples; where there are some
  double square_sum{};
  double weight_sum{};
  int free_parameters{};

  double bic() const;
  double variance() const { return square_sum / std::max(1.0, weight_sum - free_parameters); }
};

/// Nonlinear parameters after a damped step, each within its bounds and not moved by more than some of its
/// steps.
std::vector<double> MovedNonlinearParameters(std::vector<double> nonlinear_parameters,
                                             std::span<const VibrationNonlinearParameter> bounds,
                                             const SharedStep& step, double damping);

/// Levenberg–Marquardt on nonlinear parameters, down a fit's `square_sum`, until a round brings next to
/// nothing.
/// @param step_at  SharedStep of a fit
/// @param moved    the fit after a damped step: (fit, step, damping)
template <typename Fit, typename StepAt, typename Moved>
Fit Descend(Fit fit, int rounds, StepAt step_at, Moved moved) {
  double damping = 1e-3;
  for (int round = 0; round < rounds; ++round) {
    const SharedStep step = step_at(fit);
    const double before = fit.square_sum;
    bool better = false;
    for (int attempt = 0; attempt < 5 && !better; ++attempt) {
      Fit next = moved(fit, step, damping);
      better = next.square_sum < fit.square_sum;
      if (better) fit = std::move(next);
      damping = better ? std::max(1e-6, 0.2 * damping) : 8.0 * damping;
    }
    if (!better || before - fit.square_sum < 0.02 * fit.variance()) break;
  }
  return fit;
}

/// What narrow-band terms, each for itself, predict of what is left of one run. A mode moves all channels of
/// a record in one proportion: what they show of it together predicts each.
struct Predicted {
  Eigen::MatrixXd units;  // channels × terms: direction in which it moves them
  Eigen::MatrixXd along;  // samples × terms: along that direction; a channel has its part of the unit
};

/// Fits terms to the samples by least squares under weights. What narrow-band terms predict is taken off
/// what that leaves: a line's coefficients are the same in noise of any smooth spectrum, and other terms lie
/// beside the band.
class VibrationSolver {
 public:
  /// @param samples  outlive the solver
  /// @param parallel  over terms and samples of one fit; changes no bit
  VibrationSolver(const VibrationSamples& samples, std::span<const double> weights,
                  ParallelFor parallel = InTurn);

  VibrationSolution Solve(std::vector<VibrationTerm> terms,
                          const VibrationSolution* previous = nullptr) const;

  /// Levenberg–Marquardt on the nonlinear parameters of the terms from one on, at most so many rounds.
  VibrationSolution Refine(VibrationSolution solution, int rounds, std::size_t from = 0) const;

  /// Covariance of the nonlinear parameters of all terms, one after the other; fills
  /// `follows_nonlinear_parameters`.
  Eigen::MatrixXd NonlinearParameterCovariance(VibrationSolution& solution) const;

  /// What the model does not explain (innovations, where there are narrow-band terms), all samples.
  Eigen::VectorXd Residual(const VibrationSolution& solution) const;

  /// Columns of one channel, in the solution.
  SharedColumns ColumnsOfChannel(const VibrationSolution& solution, std::size_t channel) const;

  /// @param narrowband  terms that are observable in the same channels
  /// @param left  all samples
  Predicted PredictedOf(std::span<const VibrationTerm> narrowband, std::size_t run,
                        const Eigen::VectorXd& left) const;

  /// Takes off what the narrow-band terms predict.
  /// @param left  all samples, in any number of columns
  void TakeOffPredicted(std::span<const VibrationTerm> terms, Eigen::Ref<Eigen::MatrixXd> left) const;

  std::span<const double> weights() const { return weights_; }
  const ParallelFor& parallel() const { return parallel_; }

 private:
  struct RunChannel {
    std::size_t run;
    const VibrationSegment* channel;
    bool misses_samples;
  };
  /// How a narrow-band term combines the channels of a run: along a unit vector, zero where it is observable
  /// in none, but for samples that one of them misses.
  struct ChannelCombination {
    Eigen::VectorXd unit;
    InnovationFilter filter;
    std::vector<char> missing;  // empty: none
  };
  ChannelCombination CombinationOf(const VibrationTerm& narrowband, std::size_t run) const;
  /// Channels of one run, one after the other, that have the same columns.
  struct Group {
    std::size_t first;  // channel
    std::size_t count;
  };
  std::vector<Group> GroupsOf(std::span<const VibrationTerm> terms) const;
  Eigen::Map<const Eigen::MatrixXd> SamplesOf(const Group& group, const double* all) const;
  SharedStep StepOfPredicted(const VibrationSolution& solution, std::size_t from,
                             const std::vector<VibrationNonlinearParameter>& nonlinear_parameters,
                             Eigen::MatrixXd derivatives) const;
  SharedStep Step(VibrationSolution& solution, std::size_t from,
                  const std::vector<VibrationNonlinearParameter>& nonlinear_parameters) const;

  const VibrationSamples& samples_;
  ParallelFor parallel_;
  std::vector<double> weights_;
  std::vector<RunChannel> run_channels_;
  std::vector<char> breaks_;   // one a sample of the response
  std::vector<char> missing_;  // single samples without weight; a block held out is not missing, it is unseen
};

}  // namespace strainwave::analysis::diagnosis
