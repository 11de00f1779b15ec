// SPDX-License-Identifier: Apache-2.0
#include "analysis/networks/optimizer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "analysis/arguments.h"
#include "analysis/networks/adam_step.h"

namespace strainwave::analysis::networks {
namespace {

void RequireBelowOne(std::string_view name, double value) {
  if (!(value >= 0.0 && value < 1.0)) {
    throw std::invalid_argument(fmt::format("{} = {} is not from 0 to below 1", name, value));
  }
}

struct Check {
  void operator()(const Adam& adam) const {
    RequirePositive("rate", adam.rate);
    RequirePositive("epsilon", adam.epsilon);
    RequireBelowOne("beta1", adam.beta1);
    RequireBelowOne("beta2", adam.beta2);
  }
  void operator()(const MomentumDescent& descent) const {
    RequirePositive("rate", descent.rate);
    RequireBelowOne("momentum", descent.momentum);
  }
  void operator()(const ResilientPropagation& resilient) const {
    RequirePositive("least_step", resilient.least_step);
    if (!(resilient.least_step <= resilient.first_step && resilient.first_step <= resilient.most_step)) {
      throw std::invalid_argument(fmt::format("first_step = {} is not from least_step = {} to most_step = {}",
                                              resilient.first_step, resilient.least_step,
                                              resilient.most_step));
    }
    RequirePositive("shrinkage", resilient.shrinkage);
    if (!(resilient.shrinkage < 1.0 && resilient.growth > 1.0)) {
      throw std::invalid_argument(
          fmt::format("growth = {}, shrinkage = {} (expected growth above 1, shrinkage below)",
                      resilient.growth, resilient.shrinkage));
    }
  }
};

}  // namespace

template <typename Scalar>
Optimizer<Scalar>::Optimizer(OptimizerSettings settings, Eigen::Index parameters)
    : settings_(settings),
      first_(Vector<Scalar>::Zero(parameters)),
      second_(Vector<Scalar>::Zero(parameters)) {
  std::visit(Check{}, settings_);
  if (const auto* resilient = std::get_if<ResilientPropagation>(&settings_)) {
    second_.setConstant(static_cast<Scalar>(resilient->first_step));
  }
}

template <typename Scalar>
void Optimizer<Scalar>::Step(const Vector<Scalar>& gradient, double rate_factor, Vector<Scalar>& parameters) {
  ++steps_;
  std::visit([&](const auto& method) { Take(method, gradient, rate_factor, parameters); }, settings_);
}

template <typename Scalar>
void Optimizer<Scalar>::Take(const Adam& adam, const Vector<Scalar>& gradient, double rate_factor,
                             Vector<Scalar>& parameters) {
  const auto steps = static_cast<double>(steps_);
  const AdamFactors<Scalar> factors{
      .beta1 = static_cast<Scalar>(adam.beta1),
      .beta2 = static_cast<Scalar>(adam.beta2),
      .step = static_cast<Scalar>(rate_factor * adam.rate / (1.0 - std::pow(adam.beta1, steps))),
      .root = static_cast<Scalar>(std::sqrt(1.0 - std::pow(adam.beta2, steps))),
      .epsilon = static_cast<Scalar>(adam.epsilon)};
  AdamStep(factors, static_cast<std::size_t>(parameters.size()), gradient.data(), first_.data(),
           second_.data(), parameters.data());
}

template <typename Scalar>
void Optimizer<Scalar>::Take(const MomentumDescent& descent, const Vector<Scalar>& gradient,
                             double rate_factor, Vector<Scalar>& parameters) {
  first_ = static_cast<Scalar>(descent.momentum) * first_ + gradient;
  parameters -= static_cast<Scalar>(rate_factor * descent.rate) * first_;
}

template <typename Scalar>
void Optimizer<Scalar>::Take(const ResilientPropagation& resilient, const Vector<Scalar>& gradient, double,
                             Vector<Scalar>& parameters) {
  for (Eigen::Index i = 0; i < parameters.size(); ++i) {
    const Scalar agreement = gradient(i) * first_(i);
    Scalar slope = gradient(i);
    if (agreement > Scalar(0)) {
      second_(i) = std::min(second_(i) * static_cast<Scalar>(resilient.growth),
                            static_cast<Scalar>(resilient.most_step));
    } else if (agreement < Scalar(0)) {
      second_(i) = std::max(second_(i) * static_cast<Scalar>(resilient.shrinkage),
                            static_cast<Scalar>(resilient.least_step));
      slope = Scalar(0);
    }
    parameters(i) -= slope > Scalar(0) ? second_(i) : slope < Scalar(0) ? -second_(i) : Scalar(0);
    first_(i) = slope;
  }
}

template class Optimizer<float>;
template class Optimizer<double>;

}  // namespace strainwave::analysis::networks
