// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/terms.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/decompositions.h"

namespace strainwave::analysis::diagnosis {

using Eigen::Index;

namespace {

constexpr double kUnknownReversal = 3.0;  // steps of the points

// Row by row, how much of a change is friction that turns round a little earlier or later than the motion
// does: an axis that sticks for a moment has any friction below its limit.
Eigen::VectorXd SpreadOfReversals(const MotionGrid& grid) {
  const double shift_s = kUnknownReversal * grid.segments.front().step_s;
  Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(grid.nominal.rows());
  for (const double by_s : {-shift_s, shift_s})
    squares += (grid.Project(DirectionLater(grid, by_s)) - grid.nominal.col(2)).array().square();
  return (0.5 * squares).sqrt().matrix();
}

}  // namespace

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
  std::vector<NonlinearParameterDescription> numbers{
      {units.inertia_name(), units.inertia(), 1.0},
      {"viscous_" + units.viscous_suffix(), units.viscous(), 1.0},
      {"coulomb_" + units.torque(), units.torque(), 1.0}};
  for (Index record = 0; record + 3 < grid->nominal.cols(); ++record) {
    numbers.push_back(
        {record == 0 ? "offset_" + units.torque() : fmt::format("offset_{}_{}", record + 1, units.torque()),
         units.torque(), 1.0});
  }
  DescribeEach(term, std::move(numbers));
  term.model_uncertainty = [spread =
                                SpreadOfReversals(*grid)](std::span<const double> fitted) -> Eigen::VectorXd {
    return std::abs(fitted[2]) * spread;
  };
  model.nominal.push_back(std::move(term));
}

bool MovesBothWays(const MotionGrid& grid) {
  constexpr double kLeastShare = 0.05;
  const auto forward =
      static_cast<double>(std::ranges::count_if(grid.direction, [](double way) { return way > 0.0; }));
  const double share = forward / static_cast<double>(grid.direction.size());
  return std::min(share, 1.0 - share) >= kLeastShare;
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

RowSums::RowSums(const MotionGrid& grid, double span_s) {
  const auto most = std::max<Index>(1, std::lround(span_s / grid.row_spacing_s));
  each_ = most == 1;
  if (each_) {
    nominal_basis_ = grid.nominal_basis;
    return;
  }
  for (std::size_t run = 0; run < grid.response_segments.size(); ++run) {
    const bool last = run + 1 == grid.response_segments.size();
    const auto end = static_cast<Index>(last ? grid.rows() : grid.response_segments[run + 1]);
    for (auto first = static_cast<Index>(grid.response_segments[run]); first < end; first += most)
      spans_.emplace_back(first, std::min(most, end - first));
  }
  nominal_basis_ = OrthonormalBasis(Of(grid.nominal));
}

Eigen::MatrixXd RowSums::Of(const Eigen::MatrixXd& rows) const {
  if (each_) return rows;
  Eigen::MatrixXd sums(static_cast<Index>(spans_.size()), rows.cols());
  for (Index i = 0; i < sums.rows(); ++i) {
    const auto [first, count] = spans_[static_cast<std::size_t>(i)];
    sums.row(i) = rows.middleRows(first, count).colwise().sum() / std::sqrt(static_cast<double>(count));
  }
  return sums;
}

Eigen::MatrixXd RowSums::BesideNominal(const Eigen::MatrixXd& sums) const {
  return sums - nominal_basis_ * (nominal_basis_.transpose() * sums).eval();
}

Eigen::VectorXd RowSums::ResidualOf(const WeightedResidual& residual) const {
  const Eigen::Map<const Eigen::VectorXd> values(residual.values.data(),
                                                 static_cast<Index>(residual.values.size()));
  return each_ ? Eigen::VectorXd(values) : Eigen::VectorXd(BesideNominal(Of(values)));
}

Eigen::VectorXd RowSums::WeightsOf(const WeightedResidual& residual) const {
  if (!each_) return Eigen::VectorXd::Ones(count());
  return Eigen::Map<const Eigen::VectorXd>(residual.weights.data(),
                                           static_cast<Index>(residual.weights.size()));
}

NonlinearParameterMap::NonlinearParameterMap(const MotionGrid& grid,
                                             std::vector<std::vector<double>> nonlinear_parameters,
                                             double span_s)
    : sums_(grid, span_s),
      nonlinear_parameters_(std::move(nonlinear_parameters)),
      columns_(Eigen::MatrixXf::Zero(sums_.count(), static_cast<Index>(nonlinear_parameters_.size()))),
      lengths_(Eigen::VectorXd::Ones(static_cast<Index>(nonlinear_parameters_.size()))) {}

void NonlinearParameterMap::Take(Index nonlinear_parameter, const Eigen::MatrixXd& rows) {
  const Eigen::MatrixXd sums = sums_.Of(rows);
  const Eigen::MatrixXd column = sums_.BesideNominal(sums);
  const double norm = column.norm();
  // What is one with the nominal model, as an oscillation far above the motion is with the inertia, stays
  // zero.
  if (!(norm > 1e-3 * sums.norm())) return;
  columns_.col(nonlinear_parameter) = (column / norm).cast<float>();
  lengths_(nonlinear_parameter) = norm;
}

void FillMaps(const SeparableTerm& term, std::size_t rows,
              std::initializer_list<NonlinearParameterMap*> maps) {
  const std::vector<std::vector<double>>& nonlinear_parameters = (*maps.begin())->nonlinear_parameters();
  Eigen::MatrixXd column(static_cast<Index>(rows), 1);
  for (std::size_t k = 0; k < nonlinear_parameters.size(); ++k) {
    term.fill(nonlinear_parameters[k], column);
    for (NonlinearParameterMap* map : maps) map->Take(static_cast<Index>(k), column);
  }
}

Eigen::VectorXf NonlinearParameterMap::Roots(const WeightedResidual& residual) const {
  const Eigen::VectorXf weighted =
      sums_.ResidualOf(residual).cwiseProduct(sums_.WeightsOf(residual)).cast<float>();
  return (columns_.transpose() * weighted).cwiseMax(0.0F);
}

double NonlinearParameterMap::MeanSquare(const WeightedResidual& residual) const {
  return sums_.ResidualOf(residual).cwiseAbs2().cwiseProduct(sums_.WeightsOf(residual)).mean();
}

StartSearch::StartSearch(const MotionGrid& grid, const SeparableTerm& term, const WeightedResidual& residual,
                         Sign sign, double span_s)
    : sums_(grid, span_s),
      term_(term),
      sign_(sign),
      rows_(grid.nominal.rows(), static_cast<Index>(term.columns)),
      weights_(sums_.WeightsOf(residual)),
      weighted_(sums_.ResidualOf(residual).cwiseProduct(weights_)) {}

double StartSearch::Drop(std::span<const double> nonlinear_parameters) {
  term_.fill(nonlinear_parameters, rows_);
  const Eigen::MatrixXd columns = sums_.BesideNominal(sums_.Of(rows_));
  const Eigen::VectorXd right = columns.transpose() * weighted_;
  if (sign_ == Sign::kPositive && right(0) <= 0.0) return 0.0;
  const Eigen::MatrixXd gram = columns.transpose() * weights_.asDiagonal() * columns;
  return right.dot(ShortestLeastSquares(gram, right).col(0));
}

std::vector<double> StartSearch::Polish(const std::vector<double>& nonlinear_parameters,
                                        const std::vector<double>& steps) {
  constexpr double kSettled = 5e-3;        // of the drop, between the best corner and the worst
  constexpr std::size_t kRoundsEach = 10;  // for each shape, at most: on ragged ground it never settles
  const std::size_t n = nonlinear_parameters.size();
  struct Corner {
    double drop{};
    std::vector<double> nonlinear_parameters;
  };
  const auto corner_at = [&](std::vector<double> at) {
    for (std::size_t k = 0; k < n; ++k) {
      if (at[k] < term_.nonlinear_parameters[k].low || at[k] > term_.nonlinear_parameters[k].high)
        return Corner{0.0, std::move(at)};
    }
    const double drop = Drop(at);
    return Corner{drop, std::move(at)};
  };
  std::vector<Corner> corners{corner_at(nonlinear_parameters)};
  for (std::size_t k = 0; k < n; ++k) {
    std::vector<double> moved = nonlinear_parameters;
    moved[k] += moved[k] + steps[k] <= term_.nonlinear_parameters[k].high ? steps[k] : -steps[k];
    corners.push_back(corner_at(std::move(moved)));
  }
  for (std::size_t round = 0; round < kRoundsEach * n; ++round) {
    std::ranges::sort(corners, std::greater<>(), &Corner::drop);
    Corner& worst = corners.back();
    if (corners.front().drop - worst.drop <= kSettled * corners.front().drop) break;
    std::vector<double> centre(n, 0.0);
    for (std::size_t c = 0; c < n; ++c) {
      for (std::size_t k = 0; k < n; ++k)
        centre[k] += corners[c].nonlinear_parameters[k] / static_cast<double>(n);
    }
    const auto along = [&](double share) {
      std::vector<double> at(n);
      for (std::size_t k = 0; k < n; ++k)
        at[k] = centre[k] + share * (worst.nonlinear_parameters[k] - centre[k]);
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
        corners[c].nonlinear_parameters[k] =
            0.5 * (corners[c].nonlinear_parameters[k] + corners.front().nonlinear_parameters[k]);
      corners[c] = corner_at(std::move(corners[c].nonlinear_parameters));
    }
  }
  return std::ranges::max(corners, {}, &Corner::drop).nonlinear_parameters;
}

std::vector<std::vector<double>> BestStarts(const MotionGrid& grid, const SeparableTerm& term,
                                            const std::vector<std::vector<double>>& candidates,
                                            const WeightedResidual& residual, std::size_t count) {
  StartSearch search(grid, term, residual);
  std::vector<std::pair<double, std::size_t>> drops;
  for (std::size_t i = 0; i < candidates.size(); ++i) drops.emplace_back(search.Drop(candidates[i]), i);
  std::sort(drops.begin(), drops.end(), std::greater<>());
  std::vector<std::vector<double>> starts;
  for (std::size_t i = 0; i < std::min(count, drops.size()); ++i)
    starts.push_back(candidates[drops[i].second]);
  return starts;
}

}  // namespace strainwave::analysis::diagnosis
