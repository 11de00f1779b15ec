// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <variant>

#include "analysis/networks/network.h"

namespace strainwave::analysis::networks {

/// Kingma & Ba (2015), algorithm 1 with both moments corrected; `epsilon` is added to the corrected root.
struct Adam {
  double rate{1e-3};
  double beta1{0.9};
  double beta2{0.999};
  double epsilon{1e-8};
};

/// v = momentum · v + g, w −= rate · v.
struct MomentumDescent {
  double rate{1e-2};
  double momentum{0.9};
};

/// iRprop− (Igel & Hüsken 2000): each parameter has a step of its own, which grows while its gradient keeps
/// its sign; where the sign changed the gradient counts as 0 once. For whole batches; it has no rate.
struct ResilientPropagation {
  double first_step{0.0125};
  double growth{1.2};
  double shrinkage{0.5};
  double least_step{1e-6};
  double most_step{50.0};
};

using OptimizerSettings = std::variant<Adam, MomentumDescent, ResilientPropagation>;

/// What the method keeps between steps; starts at zero.
template <typename Scalar>
class Optimizer {
 public:
  /// @throws std::invalid_argument for settings out of range: rates and steps above 0, 0 ≤ betas and momentum
  ///   < 1.
  Optimizer(OptimizerSettings settings, Eigen::Index parameters);

  /// @param rate_factor  what the schedule makes of the rate.
  void Step(const Vector<Scalar>& gradient, double rate_factor, Vector<Scalar>& parameters);

 private:
  void Take(const Adam& adam, const Vector<Scalar>& gradient, double rate_factor, Vector<Scalar>& parameters);
  void Take(const MomentumDescent& descent, const Vector<Scalar>& gradient, double rate_factor,
            Vector<Scalar>& parameters);
  void Take(const ResilientPropagation& resilient, const Vector<Scalar>& gradient, double rate_factor,
            Vector<Scalar>& parameters);

  OptimizerSettings settings_;
  Vector<Scalar> first_;   // mean of the gradient; velocity; the gradient before
  Vector<Scalar> second_;  // mean of its square; none; the step of each parameter
  long long steps_{};
};

}  // namespace strainwave::analysis::networks
