// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion_terms.h"

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

std::vector<std::vector<double>> BestStarts(const MotionGrid& grid, const SeparableTerm& term,
                                            const std::vector<std::vector<double>>& candidates,
                                            const Remainder& remainder, std::size_t count) {
  const auto rows = static_cast<Eigen::Index>(grid.rows());
  const Eigen::Map<const Eigen::VectorXd> residual(remainder.residual.data(), rows);
  const Eigen::Map<const Eigen::VectorXd> weights(remainder.weights.data(), rows);
  const Eigen::VectorXd weighted = residual.cwiseProduct(weights);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> nominal(grid.nominal);
  Eigen::MatrixXd columns(rows, static_cast<Eigen::Index>(term.columns));
  std::vector<std::pair<double, std::size_t>> drops;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    term.fill(candidates[i], columns);
    columns -= grid.nominal * nominal.solve(columns);
    const Eigen::VectorXd right = columns.transpose() * weighted;
    const Eigen::MatrixXd gram = columns.transpose() * weights.asDiagonal() * columns;
    drops.emplace_back(right.dot(gram.completeOrthogonalDecomposition().solve(right)), i);
  }
  std::sort(drops.begin(), drops.end(), std::greater<>());
  std::vector<std::vector<double>> starts;
  for (std::size_t i = 0; i < std::min(count, drops.size()); ++i)
    starts.push_back(candidates[drops[i].second]);
  return starts;
}

}  // namespace strainwave::analysis::diagnosis
