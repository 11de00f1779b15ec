// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/usual_effects.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analysis/decompositions.h"
#include "analysis/diagnosis/scans.h"
#include "analysis/model/axis_motion.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

constexpr std::size_t kLines = 3;

}  // namespace

std::vector<double> StrongestOrders(const MotionGrid& grid) {
  const Eigen::Map<const Eigen::VectorXd> measured(grid.measured.data(), grid.nominal.rows());
  const Eigen::MatrixXd usual = UsualEffects(grid);
  Eigen::MatrixXd known(grid.nominal.rows(), grid.nominal.cols() + usual.cols());
  known << grid.nominal, usual;
  const Eigen::VectorXd residual =
      measured - known * LeastSquares(grid.Weighted(known), grid.Weighted(measured));
  const double per_unit = grid.linear ? kTwoPi : 1.0;
  std::vector<double> angle;
  for (const std::size_t point : grid.point_of_row) angle.push_back(grid.position[point] * per_unit);
  const auto [first, last] = std::minmax_element(angle.begin(), angle.end());
  const double turns = (*last - *first) / kTwoPi;
  std::vector<double> orders;
  for (const LinePeak& line :
       FindLines(angle, {residual.data(), grid.rows()}, grid.weights, 1.5 / turns,
                 std::min(1200.0, 0.25 * static_cast<double>(grid.rows()) / turns), kLines)) {
    orders.push_back(line.order * per_unit);
  }
  return orders;
}

Eigen::MatrixXd UsualEffectsAndLines(const MotionGrid& grid, std::span<const double> orders, double shift_s) {
  const PathPoints path = PathLater(grid, shift_s);
  const std::vector<double> direction = DirectionLater(grid, shift_s);
  const Eigen::MatrixXd usual = UsualEffects(grid, path);
  const double speed = QuantileOfMagnitude(grid.velocity, 0.95);
  Eigen::MatrixXd columns(grid.nominal.rows(), usual.cols() + 2 + 2 * static_cast<Index>(orders.size()));
  columns.leftCols(usual.cols()) = usual;
  Index column = usual.cols();
  std::vector<double> points(path.position.size());
  for (const double low : {0.03 * speed, 0.1 * speed}) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i] = direction[i] * model::StribeckShare(path.velocity[i], low);
    }
    columns.col(column++) = grid.Project(points);
  }
  for (const double order : orders) {
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = std::cos(order * path.position[i]);
    columns.col(column++) = grid.Project(points);
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = std::sin(order * path.position[i]);
    columns.col(column++) = grid.Project(points);
  }
  return columns;
}

}  // namespace strainwave::analysis::diagnosis
