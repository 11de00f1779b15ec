// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/terms.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace strainwave::analysis::diagnosis {

SeparableTerm FixedTerm(Eigen::MatrixXd columns) {
  SeparableTerm term;
  term.columns = static_cast<std::size_t>(columns.cols());
  term.fill = [columns = std::move(columns)](std::span<const double>, Eigen::Ref<Eigen::MatrixXd> design) {
    design = columns;
  };
  return term;
}

void AddNominalMotion(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  SeparableTerm term = FixedTerm(grid->nominal);
  std::vector<ShapeDescription> numbers{{units.inertia_name(), units.inertia(), 1.0},
                                        {"viscous_" + units.viscous_suffix(), units.viscous(), 1.0},
                                        {"coulomb_" + units.torque(), units.torque(), 1.0}};
  for (Eigen::Index record = 0; record + 3 < grid->nominal.cols(); ++record) {
    numbers.push_back(
        {record == 0 ? "offset_" + units.torque() : fmt::format("offset_{}_{}", record + 1, units.torque()),
         units.torque(), 1.0});
  }
  DescribeEach(term, std::move(numbers));
  model.nominal.push_back(std::move(term));
}

double ShareBesideNominal(const MotionGrid& grid, const Eigen::VectorXd& column) {
  const double all = (column.array() - column.mean()).matrix().squaredNorm();
  return all > 0.0 ? grid.BesideNominal(column).squaredNorm() / all : 0.0;
}

std::vector<double> GeometricSteps(double low, double high, std::size_t count) {
  std::vector<double> steps;
  for (std::size_t i = 0; i < count; ++i) {
    steps.push_back(low * std::pow(high / low, static_cast<double>(i) / static_cast<double>(count - 1)));
  }
  return steps;
}

StartSearch::StartSearch(const MotionGrid& grid, const SeparableTerm& term, const Remainder& remainder)
    : grid_(grid),
      term_(term),
      nominal_(grid.nominal),
      columns_(grid.nominal.rows(), static_cast<Eigen::Index>(term.columns)),
      weights_(Eigen::Map<const Eigen::VectorXd>(remainder.weights.data(), grid.nominal.rows())),
      weighted_(Eigen::Map<const Eigen::VectorXd>(remainder.residual.data(), grid.nominal.rows())
                    .cwiseProduct(weights_)) {}

double StartSearch::Drop(std::span<const double> shapes) {
  term_.fill(shapes, columns_);
  columns_ -= grid_.nominal * nominal_.solve(columns_);
  const Eigen::VectorXd right = columns_.transpose() * weighted_;
  const Eigen::MatrixXd gram = columns_.transpose() * weights_.asDiagonal() * columns_;
  return right.dot(gram.completeOrthogonalDecomposition().solve(right));
}

std::vector<double> StartSearch::Polish(std::vector<double> shapes, std::vector<double> steps) {
  double best = Drop(shapes);
  for (int halvings = 0; halvings < 5;) {
    bool better = false;
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      for (const double sign : {-1.0, 1.0}) {
        std::vector<double> moved = shapes;
        moved[k] = std::clamp(moved[k] + sign * steps[k], term_.shapes[k].low, term_.shapes[k].high);
        const double drop = Drop(moved);
        if (drop <= best) continue;
        best = drop;
        shapes = std::move(moved);
        better = true;
      }
    }
    if (better) continue;
    for (double& step : steps) step *= 0.5;
    ++halvings;
  }
  return shapes;
}

std::vector<std::vector<double>> BestStarts(const MotionGrid& grid, const SeparableTerm& term,
                                            const std::vector<std::vector<double>>& candidates,
                                            const Remainder& remainder, std::size_t count) {
  StartSearch search(grid, term, remainder);
  std::vector<std::pair<double, std::size_t>> drops;
  for (std::size_t i = 0; i < candidates.size(); ++i) drops.emplace_back(search.Drop(candidates[i]), i);
  std::sort(drops.begin(), drops.end(), std::greater<>());
  std::vector<std::vector<double>> starts;
  for (std::size_t i = 0; i < std::min(count, drops.size()); ++i)
    starts.push_back(candidates[drops[i].second]);
  return starts;
}

}  // namespace strainwave::analysis::diagnosis
