// SPDX-License-Identifier: Apache-2.0
#include "analysis/autocorrelation.h"

#include <algorithm>
#include <cmath>

namespace strainwave::analysis {
namespace {

double LagProduct(std::span<const double> x, std::size_t lag) {
  double sum = 0.0;
  for (std::size_t i = lag; i < x.size(); ++i) {
    sum += x[i] * x[i - lag];
  }
  return sum;
}

}  // namespace

Eigen::Index KernelBandwidth(std::span<const double> residual) {
  const auto n = static_cast<double>(residual.size());
  if (residual.size() < 8) {
    return 1;
  }
  const double lag0 = LagProduct(residual, 0);
  if (!(lag0 > 0.0)) {
    return 1;
  }
  const double lag1 = LagProduct(residual, 1);
  double rho = lag1 / lag0;
  if (rho > 2.5 / std::sqrt(n)) {
    rho = std::max(rho, LagProduct(residual, 2) / lag1);
  }
  // Beyond 0.98 the rule asks for more than the cap of any record that is met here.
  rho = std::clamp(rho, -0.9, 0.98);
  const double alpha = 4.0 * rho * rho / ((1.0 - rho * rho) * (1.0 - rho * rho));
  const double length = std::max(1.1447 * std::cbrt(alpha * n), std::cbrt(n));
  return static_cast<Eigen::Index>(std::ceil(std::clamp(length, 1.0, std::max(1.0, n / 8.0))));
}

double LagOneCorrelation(std::span<const double> residual) {
  const double lag0 = LagProduct(residual, 0);
  if (residual.size() < 8 || !(lag0 > 0.0)) {
    return 0.0;
  }
  return std::clamp(LagProduct(residual, 1) / lag0, -0.9, 0.9);
}

Eigen::MatrixXd Whiten(const Eigen::MatrixXd& rows, double rho) {
  Eigen::MatrixXd white = rows;
  white.bottomRows(rows.rows() - 1) -= rho * rows.topRows(rows.rows() - 1);
  white.row(0) *= std::sqrt(1.0 - rho * rho);
  return white;
}

Eigen::MatrixXd LongRunCovariance(const Eigen::MatrixXd& scores, Eigen::Index bandwidth) {
  const Eigen::Index n = scores.rows();
  // Row-major, so that a sample is one segment of memory in the running sum.
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = scores;
  const Eigen::Index windows = n + bandwidth - 1;
  Eigen::MatrixXd window_sums(windows, scores.cols());
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(scores.cols());
  for (Eigen::Index end = 0; end < windows; ++end) {
    if (end < n) {
      sum += rows.row(end);
    }
    if (end >= bandwidth) {
      sum -= rows.row(end - bandwidth);
    }
    window_sums.row(end) = sum;
  }
  return window_sums.transpose() * window_sums / static_cast<double>(bandwidth);
}

Eigen::MatrixXd ScoreCovariance(const Eigen::MatrixXd& scores, std::span<const double> residuals) {
  const double rho = LagOneCorrelation(residuals);
  const Eigen::Map<const Eigen::VectorXd> column(residuals.data(),
                                                 static_cast<Eigen::Index>(residuals.size()));
  const Eigen::MatrixXd white = Whiten(column, rho);
  const Eigen::Index bandwidth = KernelBandwidth({white.data(), residuals.size()});
  return LongRunCovariance(Whiten(scores, rho), bandwidth) / ((1.0 - rho) * (1.0 - rho));
}

double VarianceInflation(std::span<const double> residual) {
  const double independent = LagProduct(residual, 0);
  if (!(independent > 0.0)) {
    return 1.0;
  }
  const Eigen::Map<const Eigen::VectorXd> column(residual.data(), static_cast<Eigen::Index>(residual.size()));
  return std::max(1.0, ScoreCovariance(column, residual)(0, 0) / independent);
}

}  // namespace strainwave::analysis
