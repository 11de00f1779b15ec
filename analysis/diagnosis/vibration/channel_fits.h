// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "analysis/diagnosis/vibration/projection.h"
#include "analysis/parallel_for.h"

namespace strainwave::analysis::diagnosis {

/// Least squares of channels that share their columns: these are read once for all channels, which is what
/// long records spend their time with. Sums over rows are made of parts whose length does not depend on
/// threads, so that neither does a bit of the results.

/// Columns that lie in several matrices, of as many rows each.
class SharedColumns {
 public:
  void Add(const Eigen::MatrixXd& part) { parts_.push_back(&part), columns_ += part.cols(); }
  Eigen::Index rows() const { return parts_.front()->rows(); }
  Eigen::Index cols() const { return columns_; }
  /// Rows of all of them, side by side.
  Eigen::MatrixXd Rows(Eigen::Index first, Eigen::Index count) const;

 private:
  std::vector<const Eigen::MatrixXd*> parts_;  // one at least
  Eigen::Index columns_{};
};

/// Each channel by itself.
/// @param responses, weights  samples × channels
std::vector<ChannelFit> FitChannels(const SharedColumns& columns,
                                    const Eigen::Ref<const Eigen::MatrixXd>& responses,
                                    const Eigen::Ref<const Eigen::MatrixXd>& weights,
                                    const ParallelFor& parallel);

/// The same without weights, in turn.
std::vector<ChannelFit> FitChannels(const Eigen::MatrixXd& columns,
                                    const Eigen::Ref<const Eigen::MatrixXd>& responses);

/// Slopes of the columns of one term by its nonlinear parameters: `width` columns by the first of these, then
/// as many by the next.
struct TermSlopes {
  const Eigen::MatrixXd* slopes{};  // null: the channels do not depend on the term's parameters
  Eigen::Index first{};             // of the term's columns
  Eigen::Index width{};
  Eigen::Index parameters{};
  /// Without slopes: the derivatives are not zero, but computed elsewhere, and stay as they are.
  bool filled_by_others{};
};

/// The nonlinear parameters of all terms, one after the other, by which all channels are changed.
struct ChannelSlopes {
  SharedColumns columns;
  Eigen::Ref<const Eigen::MatrixXd> weights;  // samples × channels
  std::vector<const ChannelFit*> fits;        // one a channel
  std::vector<TermSlopes> terms;

  Eigen::Index parameters() const;
};

/// Adds the channels to a Gauss–Newton step on the parameters, the channels' own coefficients projected out.
/// @returns for each channel, what a change of the parameters does to its coefficients (columns × parameters)
std::vector<Eigen::MatrixXd> AddChannels(const ChannelSlopes& slopes, const ParallelFor& parallel,
                                         SharedStep& step);

/// Derivatives of the channels' models by the parameters, the columns projected out (variable projection;
/// Golub & Pereyra, SIAM J. Numer. Anal. 10 (1973) 413, as Kaufman, BIT 15 (1975) 49, simplifies it).
/// @param derivatives  samples of the first channel, then of the next × parameters
/// @returns as AddChannels
std::vector<Eigen::MatrixXd> ProjectedDerivatives(const ChannelSlopes& slopes, const ParallelFor& parallel,
                                                  Eigen::Ref<Eigen::MatrixXd> derivatives);

/// Gauss–Newton step from derivatives by the parameters and what is left.
SharedStep StepOfDerivatives(const Eigen::Ref<const Eigen::MatrixXd>& derivatives,
                             const Eigen::Ref<const Eigen::VectorXd>& left,
                             const Eigen::Ref<const Eigen::VectorXd>& weights, const ParallelFor& parallel);

/// What the fit of further columns beside others needs of the samples.
struct ProductsOfFurther {
  Eigen::MatrixXd squares;         // columnsᵀ columns
  Eigen::MatrixXd with_others;     // othersᵀ columns
  Eigen::MatrixXd with_residuals;  // columnsᵀ residuals
};
/// @param others, residuals  under the roots of the weights
/// @param root_weights  of the columns
ProductsOfFurther ProductsBeside(const Eigen::Ref<const Eigen::MatrixXd>& columns,
                                 const Eigen::Ref<const Eigen::MatrixXd>& others,
                                 const Eigen::Ref<const Eigen::MatrixXd>& residuals,
                                 const Eigen::Ref<const Eigen::VectorXd>& root_weights,
                                 const ParallelFor& parallel);

}  // namespace strainwave::analysis::diagnosis
