// SPDX-License-Identifier: Apache-2.0
#include "analysis/statistics/convex_hull.h"

#include <stdexcept>
#include <vector>

#include "analysis/decompositions.h"

namespace strainwave::analysis::statistics {
namespace {

// The x ≥ 0 that makes ‖a x − b‖ least.
Eigen::VectorXd NonNegativeLeastSquares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  const Eigen::Index n = a.cols();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  std::vector<Eigen::Index> free;
  const double tolerance = 1e-11 * std::max(1.0, (a.transpose() * b).cwiseAbs().maxCoeff());
  for (Eigen::Index round = 0; round < 3 * n + 10; ++round) {
    Eigen::VectorXd gradient = a.transpose() * (b - a * x);
    for (const Eigen::Index i : free) gradient(i) = 0.0;
    Eigen::Index next = 0;
    if (!(gradient.maxCoeff(&next) > tolerance)) break;
    free.push_back(next);
    while (!free.empty()) {
      const Eigen::MatrixXd columns = a(Eigen::all, free);
      const Eigen::VectorXd wanted = ShortestLeastSquares(columns, b);
      if (wanted.minCoeff() > 0.0) {
        x.setZero();
        for (std::size_t i = 0; i < free.size(); ++i) x(free[i]) = wanted(static_cast<Eigen::Index>(i));
        break;
      }
      double step = 1.0;
      for (std::size_t i = 0; i < free.size(); ++i) {
        const double to = wanted(static_cast<Eigen::Index>(i));
        if (to <= 0.0) step = std::min(step, x(free[i]) / (x(free[i]) - to + 1e-300));
      }
      std::vector<Eigen::Index> kept;
      for (std::size_t i = 0; i < free.size(); ++i) {
        double& value = x(free[i]);
        value += step * (wanted(static_cast<Eigen::Index>(i)) - value);
        if (value > 1e-14) {
          kept.push_back(free[i]);
        } else {
          value = 0.0;
        }
      }
      free = std::move(kept);
    }
  }
  return x;
}

}  // namespace

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
