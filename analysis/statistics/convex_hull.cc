// SPDX-License-Identifier: Apache-2.0
#include "analysis/statistics/convex_hull.h"

#include <stdexcept>

#include "analysis/decompositions.h"

namespace strainwave::analysis::statistics {
double DistanceFromHull(const Eigen::MatrixXd& points, const Eigen::VectorXd& point) {
  if (points.rows() < 1 || points.cols() != point.size())
    throw std::invalid_argument("points and place do not have the same, one or more, coordinates");
  // The sum of weights as a further coordinate, heavy enough to hold.
  constexpr double kHeavy = 1e3;
  const Eigen::Index d = points.cols();
  Eigen::MatrixXd a(d + 1, points.rows());
  a.topRows(d) = points.transpose();
  a.row(d).setConstant(kHeavy);
  Eigen::VectorXd b(d + 1);
  b << point, kHeavy;
  const Eigen::VectorXd weights = NonNegativeLeastSquares(a, b);
  const double distance = (points.transpose() * weights - point).norm();
  constexpr double kInside = 1e-7;
  return distance < kInside ? 0.0 : distance;
}

}  // namespace strainwave::analysis::statistics
