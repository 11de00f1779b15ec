// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/one_term.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/decompositions.h"
#include "analysis/diagnosis/vibration/channel_fits.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Less than BIC has it for a coefficient: the comparison, too, accepts what is beyond chance before it pays
// in full.
constexpr double kChargeLess = 5.0;
constexpr double kFilterStep = 0.1;  // of a shape's step

// Orthonormal columns that span the same; columns that coincide count once.
MatrixXd BasisOf(const MatrixXd& columns) {
  const MatrixXd products = SquaresOfColumns(columns);
  VectorXd scale = products.diagonal();
  for (Index i = 0; i < scale.size(); ++i) scale(i) = scale(i) > 0.0 ? 1.0 / std::sqrt(scale(i)) : 0.0;
  const SymmetricParts parts = SymmetricEigen(scale.asDiagonal() * products * scale.asDiagonal());
  constexpr double kSmallest = 1e-9;
  const auto dropped = (parts.values.array() < kSmallest).count();
  const Index kept = products.rows() - dropped;
  const VectorXd segment = parts.values.tail(kept).cwiseSqrt().cwiseInverse();
  return columns * (scale.asDiagonal() * parts.vectors.rightCols(kept) * segment.asDiagonal());
}

bool IsFilter(const VibrationTerm& term) { return !HasColumns(term.form); }

}  // namespace

double TermFit::bic() const {
  return weight_sum * std::log(std::max(square_sum, 1e-300) / weight_sum) +
         free_parameters * std::log(weight_sum);
}

OneTermSolver::OneTermSolver(const VibrationSamples& samples, const VibrationSolver& solver,
                             const VibrationSolution& base)
    : samples_(samples), solver_(solver), base_(base), left_(solver.Residual(base)) {
  std::size_t c = 0;
  for (std::size_t r = 0; r < samples.runs.size(); ++r) {
    const std::size_t first_group = groups_.size();
    first_of_run_.push_back(c);
    for (const VibrationSegment& channel : samples.runs[r].channels) {
      const auto n = static_cast<Index>(samples.runs[r].size());
      const VectorXd root =
          Eigen::Map<const VectorXd>(solver.weights().data() + channel.first, n).cwiseSqrt();
      std::size_t group_index = first_group;
      // A term that is not observable in some channels leaves them other columns.
      const auto same = [&](const Group& group) {
        return group.root_weights == root &&
               base.channels[group.channels.front()].first == base.channels[c].first;
      };
      while (group_index < groups_.size() && !same(groups_[group_index])) ++group_index;
      if (group_index == groups_.size()) {
        groups_.push_back({r, {}, {}, (root.array() != 1.0).any(), root, {}, MatrixXd(n, 0)});
        groups_.back().basis = BasisOf(root.asDiagonal() * solver.ColumnsOfChannel(base, c).Rows(0, n));
      }
      Group& group = groups_[group_index];
      group.channels.push_back(c);
      group.firsts.push_back(channel.first);
      group.residuals.conservativeResize(Eigen::NoChange, group.residuals.cols() + 1);
      group.residuals.rightCols(1) = root.cwiseProduct(base.channels[c].fit.residual);
      ++c;
    }
  }
}

std::vector<OneTermSolver::Products> OneTermSolver::ProductsOf(const VibrationTerm& term, bool slopes) const {
  const Index width = ColumnsOf(term);
  const Index nonlinear_parameters = slopes ? static_cast<Index>(term.nonlinear_parameters.size()) : 0;
  std::vector<Products> products;
  MatrixXd columns;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const Group& group = groups_[g];
    if (g == 0 || groups_[g - 1].run != group.run) {
      columns.resize(static_cast<Index>(samples_.runs[group.run].size()), width * (1 + nonlinear_parameters));
      columns.leftCols(width) = FillTerm(samples_, group.run, term);
      if (slopes)
        columns.rightCols(width * nonlinear_parameters) =
            FillSlopes(samples_, group.run, term, columns.leftCols(width));
    }
    const ProductsOfFurther own =
        ProductsBeside(columns, group.basis, group.residuals, group.root_weights, solver_.parallel());
    products.push_back({own.squares - own.with_others.transpose() * own.with_others, own.with_residuals});
  }
  return products;
}

TermFit OneTermSolver::Solve(VibrationTerm term, const std::vector<Products>& products) const {
  TermFit fit;
  fit.channels.resize(samples_.channels());
  fit.square_sum = base_.square_sum;
  fit.weight_sum = base_.weight_sum;
  fit.free_parameters = base_.free_parameters + static_cast<int>(term.nonlinear_parameters.size());
  const Index width = ColumnsOf(term);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const MatrixXd inverse = PseudoInverse(products[g].own.topLeftCorner(width, width));
    for (std::size_t k = 0; k < groups_[g].channels.size(); ++k) {
      const std::size_t c = groups_[g].channels[k];
      if (term.observable[c] == 0) continue;
      const VectorXd common = products[g].with_residuals.col(static_cast<Index>(k)).head(width);
      TermFit::Channel& channel = fit.channels[c];
      channel.inverse = inverse;
      channel.coefficients = inverse * common;
      channel.drop = std::max(0.0, channel.coefficients.dot(common));
      fit.square_sum -= channel.drop;
      fit.free_parameters += static_cast<int>(width);
    }
  }
  fit.term = std::move(term);
  return fit;
}

SharedStep OneTermSolver::Step(const TermFit& fit, const std::vector<Products>& products) const {
  const auto nonlinear_parameters = static_cast<Index>(fit.term.nonlinear_parameters.size());
  const Index width = ColumnsOf(fit.term);
  SharedStep step(nonlinear_parameters);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const MatrixXd& own = products[g].own;
    // Slopes with the columns' share taken out, and what they have in common with what is left.
    const MatrixXd across = own.bottomLeftCorner(width * nonlinear_parameters, width);
    const MatrixXd inverse = PseudoInverse(own.topLeftCorner(width, width));
    const MatrixXd square =
        own.bottomRightCorner(width * nonlinear_parameters, width * nonlinear_parameters) -
        across * inverse * across.transpose();
    for (std::size_t k = 0; k < groups_[g].channels.size(); ++k) {
      const VectorXd& coefficients = fit.channels[groups_[g].channels[k]].coefficients;
      if (coefficients.size() == 0) continue;
      const VectorXd common =
          products[g].with_residuals.col(static_cast<Index>(k)).tail(width * nonlinear_parameters) -
          across * coefficients;
      for (Index a = 0; a < nonlinear_parameters; ++a) {
        step.gradient(a) += coefficients.dot(common.segment(a * width, width));
        for (Index b = 0; b < nonlinear_parameters; ++b) {
          step.normal(a, b) +=
              coefficients.dot(square.block(a * width, b * width, width, width) * coefficients);
        }
      }
    }
  }
  return step;
}

VectorXd OneTermSolver::Innovations(const VibrationTerm& term) const {
  VectorXd left = left_;
  solver_.TakeOffPredicted({&term, 1}, left);
  return Eigen::Map<const VectorXd>(solver_.weights().data(), left.size()).cwiseSqrt().cwiseProduct(left);
}

template <typename Take>
void OneTermSolver::ForEachPredicted(std::span<const VibrationTerm> narrowband, const Take& take) const {
  for (std::size_t r = 0; r < samples_.runs.size(); ++r) {
    const Predicted predicted = solver_.PredictedOf(narrowband, r, left_);
    for (const Group& group : groups_) {
      if (group.run != r) continue;
      MatrixXd units(static_cast<Index>(group.channels.size()), predicted.units.cols());
      for (Index k = 0; k < units.rows(); ++k) {
        const std::size_t of_run = group.channels[static_cast<std::size_t>(k)] - first_of_run_[r];
        units.row(k) = predicted.units.row(static_cast<Index>(of_run));
      }
      if (group.weighted) {
        take(group, units, MatrixXd(group.root_weights.asDiagonal() * predicted.along));
      } else {
        take(group, units, predicted.along);
      }
    }
  }
}

TermFit OneTermSolver::SolveFilter(VibrationTerm term) const {
  TermFit fit;
  fit.channels.resize(samples_.channels());
  fit.weight_sum = base_.weight_sum;
  ForEachPredicted({&term, 1}, [&](const Group& group, const MatrixXd& units, const MatrixXd& along) {
    for (Index k = 0; k < units.rows(); ++k)
      fit.square_sum += (group.residuals.col(k) - units(k, 0) * along).squaredNorm();
  });
  fit.free_parameters = base_.free_parameters + 2 +
                        static_cast<int>(std::ranges::count_if(
                            term.observable, [](char observable) { return observable != 0; }));
  fit.term = std::move(term);
  return fit;
}

// What a change of a shape does to a channel, unit · along, is a combination of what is predicted now and of
// its changes: the products of these few series with one another and with the residuals are enough.
SharedStep OneTermSolver::StepFilter(
    const TermFit& fit, const std::vector<VibrationNonlinearParameter>& nonlinear_parameters) const {
  std::vector<VibrationTerm> terms{fit.term};
  std::vector<Index> nonlinear_parameter_of{-1};
  std::vector<double> by_of{0.0};
  for (std::size_t s = 0; s < nonlinear_parameters.size(); ++s) {
    if (s >= 2 && fit.term.observable[s - 2] == 0) continue;
    nonlinear_parameter_of.push_back(static_cast<Index>(s));
    by_of.push_back(kFilterStep * nonlinear_parameters[s].step);
    terms.push_back(fit.term);
    terms.back().nonlinear_parameters[s] += by_of.back();
  }
  const auto count = static_cast<Index>(terms.size());
  SharedStep step(static_cast<Index>(nonlinear_parameters.size()));
  ForEachPredicted(terms, [&](const Group& group, const MatrixXd& units, MatrixXd along) {
    for (Index t = 1; t < count; ++t)
      along.col(t) = (along.col(t) - along.col(0)) / by_of[static_cast<std::size_t>(t)];
    const MatrixXd own = SquaresOfColumns(along);
    const MatrixXd with_residuals = ProductsOfColumns(along, group.residuals);
    for (Index k = 0; k < units.rows(); ++k) {
      MatrixXd change = MatrixXd::Zero(count, count);  // of the channel, by shape, in these series
      for (Index t = 1; t < count; ++t) {
        change(0, t) = (units(k, t) - units(k, 0)) / by_of[static_cast<std::size_t>(t)];
        change(t, t) = units(k, t);
      }
      const MatrixXd normal = change.transpose() * own * change;
      const VectorXd gradient = change.transpose() * (with_residuals.col(k) - units(k, 0) * own.col(0));
      for (Index t = 1; t < count; ++t) {
        const Index a = nonlinear_parameter_of[static_cast<std::size_t>(t)];
        step.gradient(a) += gradient(t);
        for (Index u = 1; u < count; ++u)
          step.normal(a, nonlinear_parameter_of[static_cast<std::size_t>(u)]) += normal(t, u);
      }
    }
  });
  return step;
}

TermFit OneTermSolver::Fit(VibrationTerm term) const {
  if (IsFilter(term)) return SolveFilter(std::move(term));
  const std::vector<Products> products = ProductsOf(term, false);
  return Solve(std::move(term), products);
}

TermFit OneTermSolver::Refine(TermFit fit, int rounds) const {
  if (fit.term.nonlinear_parameters.empty()) return fit;
  const bool filter = IsFilter(fit.term);
  const std::vector<VibrationNonlinearParameter> nonlinear_parameters =
      NonlinearParametersOf(samples_, fit.term);
  // Slopes cost a column a shape each: a step that is refused needs none.
  return Descend(
      std::move(fit), rounds,
      [&](const TermFit& at) {
        return filter ? StepFilter(at, nonlinear_parameters) : Step(at, ProductsOf(at.term, true));
      },
      [&](const TermFit& at, const SharedStep& step, double damping) {
        VibrationTerm moved = at.term;
        moved.nonlinear_parameters =
            MovedNonlinearParameters(moved.nonlinear_parameters, nonlinear_parameters, step, damping);
        return Fit(std::move(moved));
      });
}

void OneTermSolver::Prune(TermFit& fit) const {
  const Index width = ColumnsOf(fit.term);
  if (width == 0 || fit.channels.size() < 2) return;
  const double cost = static_cast<double>(width) * (std::log(fit.weight_sum) - kChargeLess) * fit.variance();
  const auto largest = std::ranges::max_element(fit.channels, {}, &TermFit::Channel::drop);
  for (auto channel = fit.channels.begin(); channel != fit.channels.end(); ++channel) {
    char& observable = fit.term.observable[static_cast<std::size_t>(channel - fit.channels.begin())];
    if (observable == 0 || channel == largest || channel->drop > cost) continue;
    fit.square_sum += channel->drop;
    fit.free_parameters -= static_cast<int>(width);
    *channel = {};
    observable = 0;
  }
}

VectorXd OneTermSolver::Residual(const TermFit& fit) const {
  if (IsFilter(fit.term)) return Innovations(fit.term);
  VectorXd residual(static_cast<Index>(samples_.measured.size()));
  for (const Group& group : groups_) {
    MatrixXd own = FillTerm(samples_, group.run, fit.term);
    if (group.weighted) own.array().colwise() *= group.root_weights.array();
    own -= group.basis * ProductsOfColumns(group.basis, own);
    for (std::size_t k = 0; k < group.channels.size(); ++k) {
      const std::size_t c = group.channels[k];
      auto part = residual.segment(static_cast<Index>(group.firsts[k]), own.rows());
      part = group.residuals.col(static_cast<Index>(k));
      if (fit.term.observable[c] != 0) part -= own * fit.channels[c].coefficients;
    }
  }
  return residual;
}

}  // namespace strainwave::analysis::diagnosis
