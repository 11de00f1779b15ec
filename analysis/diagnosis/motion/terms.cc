// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/terms.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/decompositions.h"

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

ShapeMap::ShapeMap(const MotionGrid& grid, const SeparableTerm& term, std::vector<std::vector<double>> shapes)
    : shapes_(std::move(shapes)),
      columns_(Eigen::MatrixXf::Zero(grid.nominal.rows(), static_cast<Eigen::Index>(shapes_.size()))),
      lengths_(Eigen::VectorXd::Ones(static_cast<Eigen::Index>(shapes_.size()))) {
  Eigen::MatrixXd column(grid.nominal.rows(), 1);
  for (std::size_t k = 0; k < shapes_.size(); ++k) {
    term.fill(shapes_[k], column);
    const double before = column.norm();
    column = grid.BesideNominal(column);
    const double norm = column.norm();
    // What is one with the nominal model, as a swing far above the motion is with the inertia, stays zero.
    if (!(norm > 1e-3 * before)) continue;
    columns_.col(static_cast<Eigen::Index>(k)) = (column / norm).cast<float>();
    lengths_(static_cast<Eigen::Index>(k)) = norm;
  }
}

Eigen::VectorXf ShapeMap::Roots(const Remainder& remainder) const {
  const auto rows = static_cast<Eigen::Index>(remainder.residual.size());
  const Eigen::VectorXf weighted =
      Eigen::Map<const Eigen::VectorXd>(remainder.residual.data(), rows)
          .cwiseProduct(Eigen::Map<const Eigen::VectorXd>(remainder.weights.data(), rows))
          .cast<float>();
  return (columns_.transpose() * weighted).cwiseMax(0.0F);
}

StartSearch::StartSearch(const MotionGrid& grid, const SeparableTerm& term, const Remainder& remainder,
                         Sign sign)
    : grid_(grid),
      term_(term),
      sign_(sign),
      columns_(grid.nominal.rows(), static_cast<Eigen::Index>(term.columns)),
      weights_(Eigen::Map<const Eigen::VectorXd>(remainder.weights.data(), grid.nominal.rows())),
      weighted_(Eigen::Map<const Eigen::VectorXd>(remainder.residual.data(), grid.nominal.rows())
                    .cwiseProduct(weights_)) {}

double StartSearch::Drop(std::span<const double> shapes) {
  term_.fill(shapes, columns_);
  columns_ = grid_.BesideNominal(columns_);
  const Eigen::VectorXd right = columns_.transpose() * weighted_;
  if (sign_ == Sign::kPositive && right(0) <= 0.0) return 0.0;
  const Eigen::MatrixXd gram = columns_.transpose() * weights_.asDiagonal() * columns_;
  return right.dot(ShortestLeastSquares(gram, right).col(0));
}

std::vector<double> StartSearch::Polish(const std::vector<double>& shapes, const std::vector<double>& steps) {
  constexpr double kSettled = 5e-3;  // of the drop, between the best corner and the worst
  const std::size_t n = shapes.size();
  struct Corner {
    double drop{};
    std::vector<double> shapes;
  };
  const auto corner_at = [&](std::vector<double> at) {
    for (std::size_t k = 0; k < n; ++k) {
      if (at[k] < term_.shapes[k].low || at[k] > term_.shapes[k].high) return Corner{0.0, std::move(at)};
    }
    const double drop = Drop(at);
    return Corner{drop, std::move(at)};
  };
  std::vector<Corner> corners{corner_at(shapes)};
  for (std::size_t k = 0; k < n; ++k) {
    std::vector<double> moved = shapes;
    moved[k] += moved[k] + steps[k] <= term_.shapes[k].high ? steps[k] : -steps[k];
    corners.push_back(corner_at(std::move(moved)));
  }
  for (std::size_t round = 0; round < 30 * n; ++round) {
    std::ranges::sort(corners, std::greater<>(), &Corner::drop);
    Corner& worst = corners.back();
    if (corners.front().drop - worst.drop <= kSettled * corners.front().drop) break;
    std::vector<double> centre(n, 0.0);
    for (std::size_t c = 0; c < n; ++c) {
      for (std::size_t k = 0; k < n; ++k) centre[k] += corners[c].shapes[k] / static_cast<double>(n);
    }
    const auto along = [&](double share) {
      std::vector<double> at(n);
      for (std::size_t k = 0; k < n; ++k) at[k] = centre[k] + share * (worst.shapes[k] - centre[k]);
      return corner_at(std::move(at));
    };
    Corner reflected = along(-1.0);
    if (reflected.drop > corners.front().drop) {
      Corner further = along(-2.0);
      worst = further.drop > reflected.drop ? std::move(further) : std::move(reflected);
      continue;
    }
    if (reflected.drop > corners[n - 1].drop) {
      worst = std::move(reflected);
      continue;
    }
    Corner nearer = along(reflected.drop > worst.drop ? -0.5 : 0.5);
    if (nearer.drop > std::max(worst.drop, reflected.drop)) {
      worst = std::move(nearer);
      continue;
    }
    for (std::size_t c = 1; c <= n; ++c) {
      for (std::size_t k = 0; k < n; ++k)
        corners[c].shapes[k] = 0.5 * (corners[c].shapes[k] + corners.front().shapes[k]);
      corners[c] = corner_at(std::move(corners[c].shapes));
    }
  }
  return std::ranges::max(corners, {}, &Corner::drop).shapes;
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
