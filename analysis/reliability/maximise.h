// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace strainwave::analysis::reliability {

/// A log-likelihood at a point, with its first and second derivatives.
struct Evaluation {
  double value{};
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
};

/// A value that is not finite is a point that cannot be; derivatives are asked for where the value is finite.
using LogLikelihood = std::function<Evaluation(const Eigen::VectorXd&)>;

/// Of a function that gives the value alone: derivatives by central differences of `step`, whose error is of
/// the order of its square. For parameters that are logarithms, or near 1.
LogLikelihood ByDifferences(std::function<double(const Eigen::VectorXd&)> value, double step = 1e-4);

struct Maximum {
  Eigen::VectorXd at;
  Evaluation evaluation;
};

/// Newton's method with a ridge where the Hessian is not negative definite, and steps halved until the value
/// grows, from a point where it is finite. @param fixed  coordinates that stay as they are.
/// Nothing where it does not come to rest: the likelihood has no maximum, or none that is near.
std::optional<Maximum> Maximise(const LogLikelihood& function, Eigen::VectorXd start,
                                const std::vector<Eigen::Index>& fixed = {});

}  // namespace strainwave::analysis::reliability
