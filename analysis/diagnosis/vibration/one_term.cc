// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/one_term.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/decompositions.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Less than BIC has it for a coefficient: the judge, too, believes what is beyond chance before it pays in
// full.
constexpr double kChargeLess = 5.0;
constexpr double kSlopeStep = 0.1;  // of a shape's step

// Orthonormal columns that span the same; columns that coincide count once.
MatrixXd BasisOf(const MatrixXd& columns) {
  const MatrixXd products = columns.transpose() * columns;
  VectorXd scale = products.diagonal();
  for (Index i = 0; i < scale.size(); ++i) scale(i) = scale(i) > 0.0 ? 1.0 / std::sqrt(scale(i)) : 0.0;
  const SymmetricParts parts = SymmetricEigen(scale.asDiagonal() * products * scale.asDiagonal());
  constexpr double kSmallest = 1e-9;
  const auto dropped = (parts.values.array() < kSmallest).count();
  const Index kept = products.rows() - dropped;
  const VectorXd stretch = parts.values.tail(kept).cwiseSqrt().cwiseInverse();
  return columns * (scale.asDiagonal() * parts.vectors.rightCols(kept) * stretch.asDiagonal());
}

bool IsFilter(const VibrationTerm& term) { return !HasColumns(term.form); }

}  // namespace

double TermFit::bic() const {
  return weight_sum * std::log(std::max(square_sum, 1e-300) / weight_sum) +
         free_parameters * std::log(weight_sum);
}

OneTermSolver::OneTermSolver(const VibrationSamples& samples, const VibrationSolver& solver,
                             const VibrationSolution& base)
    : samples_(samples), solver_(solver), base_(base) {
  std::size_t c = 0;
  for (std::size_t r = 0; r < samples.runs.size(); ++r) {
    const std::size_t first_of_run = groups_.size();
    for (const VibrationStretch& channel : samples.runs[r].channels) {
      const auto n = static_cast<Index>(samples.runs[r].size());
      const VectorXd root =
          Eigen::Map<const VectorXd>(solver.weights().data() + channel.first, n).cwiseSqrt();
      std::size_t place = first_of_run;
      // A term that some channels do not hear leaves them other columns.
      const auto same = [&](const Group& group) {
        return group.root_weights == root &&
               base.channels[group.channels.front()].first == base.channels[c].first;
      };
      while (place < groups_.size() && !same(groups_[place])) ++place;
      const MatrixXd all = solver.Assemble(base, c);
      if (place == groups_.size()) {
        groups_.push_back({r, {}, {}, (root.array() != 1.0).any(), root, {}, MatrixXd(n, 0)});
        groups_.back().basis = BasisOf(root.asDiagonal() * all.leftCols(all.cols() - 1));
      }
      Group& group = groups_[place];
      group.channels.push_back(c);
      group.firsts.push_back(channel.first);
      group.residuals.conservativeResize(Eigen::NoChange, group.residuals.cols() + 1);
      group.residuals.rightCols(1) = root.cwiseProduct(base.channels[c].fit.residual);
      ++c;
    }
  }
}

MatrixXd OneTermSolver::Weighted(const Group& group, MatrixXd columns) const {
  if (group.weighted) columns.array().colwise() *= group.root_weights.array();
  return columns;
}

std::vector<OneTermSolver::Products> OneTermSolver::ProductsOf(const VibrationTerm& term, bool slopes) const {
  const Index width = ColumnsOf(term);
  std::vector<VibrationShape> shapes;
  if (slopes) shapes = ShapesOf(samples_, term);
  std::vector<Products> products;
  MatrixXd columns;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const Group& group = groups_[g];
    if (g == 0 || groups_[g - 1].run != group.run) {
      columns.resize(static_cast<Index>(samples_.runs[group.run].size()),
                     width * (1 + static_cast<Index>(shapes.size())));
      columns.leftCols(width) = FillTerm(samples_, group.run, term);
      for (std::size_t s = 0; s < shapes.size(); ++s) {
        columns.middleCols(width * (1 + static_cast<Index>(s)), width) =
            FillSlope(samples_, group.run, term, columns.leftCols(width), s, kSlopeStep * shapes[s].step);
      }
    }
    const MatrixXd own = Weighted(group, columns);
    const MatrixXd along = group.basis.transpose() * own;
    MatrixXd square = MatrixXd::Zero(own.cols(), own.cols());
    square.selfadjointView<Eigen::Lower>().rankUpdate(own.transpose());
    square.selfadjointView<Eigen::Lower>().rankUpdate(along.transpose(), -1.0);
    products.push_back({square.selfadjointView<Eigen::Lower>(), own.transpose() * group.residuals});
  }
  return products;
}

TermFit OneTermSolver::Solve(VibrationTerm term, const std::vector<Products>& products) const {
  TermFit fit;
  fit.channels.resize(samples_.channels());
  fit.square_sum = base_.square_sum;
  fit.weight_sum = base_.weight_sum;
  fit.free_parameters = base_.free_parameters + static_cast<int>(term.shapes.size());
  const Index width = ColumnsOf(term);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const MatrixXd inverse = PseudoInverse(products[g].own.topLeftCorner(width, width));
    for (std::size_t k = 0; k < groups_[g].channels.size(); ++k) {
      const std::size_t c = groups_[g].channels[k];
      if (term.heard[c] == 0) continue;
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
  const auto shapes = static_cast<Index>(fit.term.shapes.size());
  const Index width = ColumnsOf(fit.term);
  SharedStep step(shapes);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const MatrixXd& own = products[g].own;
    // Slopes with the columns' share taken out, and what they have in common with what is left.
    const MatrixXd across = own.bottomLeftCorner(width * shapes, width);
    const MatrixXd inverse = PseudoInverse(own.topLeftCorner(width, width));
    const MatrixXd square =
        own.bottomRightCorner(width * shapes, width * shapes) - across * inverse * across.transpose();
    for (std::size_t k = 0; k < groups_[g].channels.size(); ++k) {
      const VectorXd& coefficients = fit.channels[groups_[g].channels[k]].coefficients;
      if (coefficients.size() == 0) continue;
      const VectorXd common =
          products[g].with_residuals.col(static_cast<Index>(k)).tail(width * shapes) - across * coefficients;
      for (Index a = 0; a < shapes; ++a) {
        step.gradient(a) += coefficients.dot(common.segment(a * width, width));
        for (Index b = 0; b < shapes; ++b) {
          step.normal(a, b) +=
              coefficients.dot(square.block(a * width, b * width, width, width) * coefficients);
        }
      }
    }
  }
  return step;
}

VectorXd OneTermSolver::Innovations(const VibrationTerm& term) const {
  VectorXd left = solver_.Residual(base_);
  solver_.TakeOffForetold({&term, 1}, left);
  return Eigen::Map<const VectorXd>(solver_.weights().data(), left.size()).cwiseSqrt().cwiseProduct(left);
}

TermFit OneTermSolver::SolveFilter(VibrationTerm term) const {
  TermFit fit;
  fit.channels.resize(samples_.channels());
  fit.weight_sum = base_.weight_sum;
  fit.square_sum = Innovations(term).squaredNorm();
  fit.free_parameters =
      base_.free_parameters + 2 +
      static_cast<int>(std::ranges::count_if(term.heard, [](char heard) { return heard != 0; }));
  fit.term = std::move(term);
  return fit;
}

SharedStep OneTermSolver::StepFilter(const TermFit& fit, const std::vector<VibrationShape>& shapes) const {
  const VectorXd here = Innovations(fit.term);
  MatrixXd slopes = MatrixXd::Zero(here.size(), static_cast<Index>(shapes.size()));
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    if (s >= 2 && fit.term.heard[s - 2] == 0) continue;
    VibrationTerm moved = fit.term;
    const double by = kSlopeStep * shapes[s].step;
    moved.shapes[s] += by;
    slopes.col(static_cast<Index>(s)) = (here - Innovations(moved)) / by;
  }
  SharedStep step(slopes.cols());
  step.normal.noalias() = slopes.transpose() * slopes;
  step.gradient.noalias() = slopes.transpose() * here;
  return step;
}

TermFit OneTermSolver::Fit(VibrationTerm term) const {
  if (IsFilter(term)) return SolveFilter(std::move(term));
  const std::vector<Products> products = ProductsOf(term, false);
  return Solve(std::move(term), products);
}

TermFit OneTermSolver::Refine(TermFit fit, int rounds) const {
  if (fit.term.shapes.empty()) return fit;
  const bool filter = IsFilter(fit.term);
  const std::vector<VibrationShape> shapes = ShapesOf(samples_, fit.term);
  // Slopes cost a column a shape each: a step that is refused needs none.
  return Descend(
      std::move(fit), rounds,
      [&](const TermFit& at) {
        return filter ? StepFilter(at, shapes) : Step(at, ProductsOf(at.term, true));
      },
      [&](const TermFit& at, const SharedStep& step, double damping) {
        VibrationTerm moved = at.term;
        moved.shapes = MovedShapes(moved.shapes, shapes, step, damping);
        return Fit(std::move(moved));
      });
}

void OneTermSolver::Prune(TermFit& fit) const {
  const Index width = ColumnsOf(fit.term);
  if (width == 0 || fit.channels.size() < 2) return;
  const double cost = static_cast<double>(width) * (std::log(fit.weight_sum) - kChargeLess) * fit.variance();
  const auto loudest = std::ranges::max_element(fit.channels, {}, &TermFit::Channel::drop);
  for (auto channel = fit.channels.begin(); channel != fit.channels.end(); ++channel) {
    char& heard = fit.term.heard[static_cast<std::size_t>(channel - fit.channels.begin())];
    if (heard == 0 || channel == loudest || channel->drop > cost) continue;
    fit.square_sum += channel->drop;
    fit.free_parameters -= static_cast<int>(width);
    *channel = {};
    heard = 0;
  }
}

VectorXd OneTermSolver::Residual(const TermFit& fit) const {
  if (IsFilter(fit.term)) return Innovations(fit.term);
  VectorXd residual(static_cast<Index>(samples_.measured.size()));
  for (const Group& group : groups_) {
    MatrixXd own = Weighted(group, FillTerm(samples_, group.run, fit.term));
    own -= group.basis * (group.basis.transpose() * own);
    for (std::size_t k = 0; k < group.channels.size(); ++k) {
      const std::size_t c = group.channels[k];
      auto part = residual.segment(static_cast<Index>(group.firsts[k]), own.rows());
      part = group.residuals.col(static_cast<Index>(k));
      if (fit.term.heard[c] != 0) part -= own * fit.channels[c].coefficients;
    }
  }
  return residual;
}

}  // namespace strainwave::analysis::diagnosis
