// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/delay.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/diagnosis/scans.h"
#include "analysis/model/axis_motion.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

constexpr double kClearly = 12.0;  // in −2 log-likelihood
constexpr std::size_t kLines = 3;

// The nominal terms of motion a time later.
Eigen::MatrixXd MotionLater(const MotionGrid& grid, double shift_s) {
  Eigen::MatrixXd later(grid.nominal.rows(), 3);
  later.col(0) = grid.ProjectPassed(grid.Later(grid.passed_acceleration, shift_s));
  later.col(1) = grid.ProjectPassed(grid.Later(grid.velocity, shift_s));
  later.col(2) = grid.Project(grid.direction, 0, shift_s);
  return later;
}

double LongestDelay_s(const MotionGrid& grid) {
  double duration_s = 0.0;
  for (const MotionGrid::Stretch& stretch : grid.stretches) {
    duration_s += stretch.step_s * static_cast<double>(stretch.count);
  }
  return std::min(std::max(0.06, 8.0 * grid.row_spacing_s), 0.02 * duration_s);
}

// Orthonormal columns of what may be in the record beside the nominal terms of motion: offsets, usual
// effects, friction of low speed, the strongest lines over position.
Eigen::MatrixXd Beside(const MotionGrid& grid, const Eigen::VectorXd& measured) {
  const Eigen::MatrixXd usual = UsualEffects(grid);
  Eigen::MatrixXd known(grid.nominal.rows(), grid.nominal.cols() + usual.cols());
  known << grid.nominal, usual;
  const Eigen::VectorXd residual = measured - known * known.colPivHouseholderQr().solve(measured);
  std::vector<double> angle;
  for (const std::size_t point : grid.point_of_row) {
    angle.push_back(grid.position[point] * (grid.linear ? kTwoPi : 1.0));
  }
  const auto [first, last] = std::minmax_element(angle.begin(), angle.end());
  const double turns = (*last - *first) / kTwoPi;
  const std::vector<double> weights(angle.size(), 1.0);
  const std::vector<LinePeak> lines =
      FindLines(angle, {residual.data(), grid.rows()}, weights, 1.5 / turns,
                std::min(1200.0, 0.25 * static_cast<double>(grid.rows()) / turns), kLines);
  const Index records = grid.nominal.cols() - 3;
  const double speed = QuantileOfMagnitude(grid.velocity, 0.95);
  const std::vector<double> low_speeds{0.03 * speed, 0.1 * speed};
  Eigen::MatrixXd beside(grid.nominal.rows(),
                         records + usual.cols() + 2 + 2 * static_cast<Index>(lines.size()));
  beside.leftCols(records) = grid.nominal.rightCols(records);
  beside.middleCols(records, usual.cols()) = usual;
  Index column = records + usual.cols();
  std::vector<double> points(grid.position.size());
  for (const double low : low_speeds) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i] = grid.direction[i] * model::StribeckShare(grid.velocity[i], low);
    }
    beside.col(column++) = grid.Project(points);
  }
  for (const LinePeak& line : lines) {
    const double order = line.order * (grid.linear ? kTwoPi : 1.0);
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = std::cos(order * grid.position[i]);
    beside.col(column++) = grid.Project(points);
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = std::sin(order * grid.position[i]);
    beside.col(column++) = grid.Project(points);
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(beside);
  return factor.householderQ() * Eigen::MatrixXd::Identity(beside.rows(), factor.rank());
}

}  // namespace

double EstimateDelay_s(const MotionGrid& grid) {
  const Eigen::Map<const Eigen::VectorXd> measured(grid.measured.data(), grid.nominal.rows());
  const Eigen::MatrixXd basis = Beside(grid, measured);
  const Eigen::VectorXd rest = measured - basis * (basis.transpose() * measured);
  const auto left = [&](double delay_s) {
    Eigen::MatrixXd later = MotionLater(grid, delay_s);
    later -= basis * (basis.transpose() * later);
    return (rest - later * later.colPivHouseholderQr().solve(rest)).squaredNorm();
  };
  constexpr int kSteps = 32;
  const double without = left(0.0);
  double best_s = 0.0;
  double least = without;
  const double step_s = LongestDelay_s(grid) / kSteps;
  for (int k = 1; k <= kSteps; ++k) {
    const double value = left(k * step_s);
    if (value < least) least = value, best_s = k * step_s;
  }
  for (double half_s = 0.5 * step_s; half_s > 0.01 * step_s; half_s *= 0.5) {
    for (const double delay_s : {best_s - half_s, best_s + half_s}) {
      if (delay_s < 0.0) continue;
      const double value = left(delay_s);
      if (value < least) least = value, best_s = delay_s;
    }
  }
  const double drop = static_cast<double>(grid.rows()) * std::log(without / least);
  return drop < kClearly ? 0.0 : best_s;
}

void AddDelayCause(const SharedGrid& grid, double delay_s, const MotionUnits& units, SeparableModel& model) {
  const Eigen::Map<const Eigen::VectorXd> measured(grid->measured.data(), grid->nominal.rows());
  // Where the nominal model fits best when it is moved: there the term is linearised.
  const double about_s = std::max(delay_s, 0.1 * grid->row_spacing_s);
  Eigen::MatrixXd later = grid->nominal;
  later.leftCols(3) = MotionLater(*grid, about_s);
  const Eigen::VectorXd numbers = later.colPivHouseholderQr().solve(measured);
  SeparableTerm term = FixedTerm((later - grid->nominal) * numbers / about_s);
  DescribeEach(term, {{"delay_s", "s", 1.0}});
  model.causes.push_back(std::move(term));
  model.rules.push_back(
      {.name = "time_delay",
       .sentence =
           units.linear
               ? "the force acts later than it is recorded: a slow current loop, a bus cycle, or two clocks"
               : "the torque acts later than it is recorded: a slow current loop, a bus cycle, or two clocks",
       .where = Where::kBench,
       .effect = "E20",
       .parameters = {{"delay_s", "s", 0.0, std::numeric_limits<double>::max(), true}},
       .trials = 3.0});
}

}  // namespace strainwave::analysis::diagnosis
