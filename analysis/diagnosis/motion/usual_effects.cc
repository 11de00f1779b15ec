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

Eigen::MatrixXd UsualEffectsAndLines(const MotionGrid& grid) {
  const Eigen::Map<const Eigen::VectorXd> measured(grid.measured.data(), grid.nominal.rows());
  const Eigen::MatrixXd usual = UsualEffects(grid);
  Eigen::MatrixXd known(grid.nominal.rows(), grid.nominal.cols() + usual.cols());
  known << grid.nominal, usual;
  const Eigen::VectorXd residual = measured - known * LeastSquares(known, measured);
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
  const double speed = QuantileOfMagnitude(grid.velocity, 0.95);
  Eigen::MatrixXd columns(grid.nominal.rows(), usual.cols() + 2 + 2 * static_cast<Index>(lines.size()));
  columns.leftCols(usual.cols()) = usual;
  Index column = usual.cols();
  std::vector<double> points(grid.position.size());
  for (const double low : {0.03 * speed, 0.1 * speed}) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i] = grid.direction[i] * model::StribeckShare(grid.velocity[i], low);
    }
    columns.col(column++) = grid.Project(points);
  }
  for (const LinePeak& line : lines) {
    const double order = line.order * (grid.linear ? kTwoPi : 1.0);
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = std::cos(order * grid.position[i]);
    columns.col(column++) = grid.Project(points);
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = std::sin(order * grid.position[i]);
    columns.col(column++) = grid.Project(points);
  }
  return columns;
}

}  // namespace strainwave::analysis::diagnosis
