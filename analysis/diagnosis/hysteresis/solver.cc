// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include "analysis/decompositions.h"
#include "analysis/diagnosis/hysteresis/model.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

double CostOf(const LoopGrid& grid, const Eigen::VectorXd& predicted) {
  double cost = 0.0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const double residual = grid.twist_rad[i] - predicted(static_cast<Index>(i));
    cost += grid.weight[i] * residual * residual;
  }
  return cost;
}

}  // namespace

LoopSolution SolveLoop(const LoopModel& model, const LoopGrid& grid, const Eigen::VectorXd& start,
                       int most_iterations) {
  // What a further step would change is then small beside what chance makes of the likelihood.
  const double settled = 3e-2 / static_cast<double>(grid.size());
  constexpr double kGiveUp = 1e10;
  const Index p = model.size();
  const Eigen::Map<const Eigen::VectorXd> twist(grid.twist_rad.data(), static_cast<Index>(grid.size()));
  const Eigen::Map<const Eigen::VectorXd> weight(grid.weight.data(), twist.size());
  const Eigen::VectorXd root = weight.cwiseSqrt();
  LoopSolution best{start, 0.0};
  for (Index k = 0; k < p; ++k) {
    const FitNumber& number = model.numbers()[static_cast<std::size_t>(k)];
    if (number.high > number.low) best.numbers[k] = std::clamp(best.numbers[k], number.low, number.high);
  }
  Eigen::MatrixXd derivatives;
  double damping = 1e-4;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    const Eigen::VectorXd residual = twist - model.Predict(best.numbers, grid, derivatives);
    best.cost = residual.cwiseAbs2().dot(weight);
    const Eigen::MatrixXd whitened = root.asDiagonal() * derivatives;
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(p, p);
    normal.selfadjointView<Eigen::Lower>().rankUpdate(whitened.transpose());
    normal.triangularView<Eigen::StrictlyUpper>() = normal.transpose();
    const Eigen::VectorXd gradient = whitened.transpose() * root.cwiseProduct(residual);
    const double before = best.cost;
    double surprise = before;  // by how much a step's gain is not as predicted
    bool better = false;
    while (!better && damping < kGiveUp) {
      // Numbers without effect, or that would leave their bounds, stay for this step.
      std::vector<Index> free;
      for (Index k = 0; k < p; ++k) {
        const FitNumber& number = model.numbers()[static_cast<std::size_t>(k)];
        const bool leaves = (best.numbers[k] <= number.low && gradient[k] < 0.0) ||
                            (best.numbers[k] >= number.high && gradient[k] > 0.0);
        if (normal(k, k) > 0.0 && !leaves) free.push_back(k);
      }
      Eigen::VectorXd next = best.numbers;
      // A number that runs into its bound stops there, and the others are solved again beside it.
      for (bool again = true; again && !free.empty();) {
        again = false;
        const auto m = static_cast<Index>(free.size());
        Eigen::MatrixXd a(m, m);
        Eigen::VectorXd b(m);
        Eigen::VectorXd scale(m);
        for (Index i = 0; i < m; ++i)
          scale(i) =
              1.0 / std::sqrt(normal(free[static_cast<std::size_t>(i)], free[static_cast<std::size_t>(i)]));
        const Eigen::VectorXd moved = next - best.numbers;
        for (Index i = 0; i < m; ++i) {
          const Index row = free[static_cast<std::size_t>(i)];
          double fixed = 0.0;
          for (Index k = 0; k < p; ++k) {
            if (moved[k] != 0.0) fixed += normal(row, k) * moved[k];
          }
          b(i) = scale(i) * (gradient[row] - fixed);
          for (Index j = 0; j < m; ++j)
            a(i, j) = scale(i) * scale(j) * normal(row, free[static_cast<std::size_t>(j)]);
          a(i, i) += damping;
        }
        const Eigen::VectorXd step = scale.cwiseProduct(SymmetricFactor(a).Solve(b));
        if (!step.allFinite()) break;
        std::vector<Index> inside;
        for (Index i = 0; i < m; ++i) {
          const Index k = free[static_cast<std::size_t>(i)];
          const FitNumber& number = model.numbers()[static_cast<std::size_t>(k)];
          const double goal = best.numbers[k] + step(i);
          if (goal < number.low || goal > number.high) {
            next[k] = std::clamp(goal, number.low, number.high);
            again = true;
          } else {
            inside.push_back(k);
          }
        }
        if (!again) {
          for (Index i = 0; i < m; ++i) next[free[static_cast<std::size_t>(i)]] += step(i);
        }
        free = std::move(inside);
      }
      const double cost = CostOf(grid, model.Predict(next, grid));
      if (std::isfinite(cost) && cost < best.cost) {
        better = true;
        const Eigen::VectorXd step = next - best.numbers;
        surprise = std::abs(before - cost - 2.0 * gradient.dot(step) + step.dot(normal * step));
        best = {std::move(next), cost};
        damping = std::max(0.1 * damping, 1e-9);
      } else {
        damping = std::max(10.0 * damping, 1e-6);
      }
    }
    // A step that brought what it predicted leaves to the next one no more than what it is wrong by.
    if (!better || std::min(before - best.cost, surprise) <= settled * best.cost) break;
  }
  return best;
}

}  // namespace strainwave::analysis::diagnosis
