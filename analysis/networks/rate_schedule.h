// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <variant>

namespace strainwave::analysis::networks {

struct ConstantRate {};

/// Times `factor` after every `epochs` epochs.
struct StepRate {
  int epochs{100};
  double factor{0.5};
};

/// Times `factor` after every epoch.
struct ExponentialRate {
  double factor{0.995};
};

/// Half a cosine from 1 down to `last` over all epochs.
struct CosineRate {
  double last{0.0};
};

using RateSchedule = std::variant<ConstantRate, StepRate, ExponentialRate, CosineRate>;

/// What the rate of epoch 0 … epochs − 1 is multiplied by.
inline double RateFactor(const RateSchedule& schedule, int epoch, int epochs) {
  struct Factor {
    int epoch;
    int epochs;
    double operator()(const ConstantRate&) const { return 1.0; }
    double operator()(const StepRate& rate) const { return std::pow(rate.factor, epoch / rate.epochs); }
    double operator()(const ExponentialRate& rate) const { return std::pow(rate.factor, epoch); }
    double operator()(const CosineRate& rate) const {
      const double share = epochs > 1 ? static_cast<double>(epoch) / static_cast<double>(epochs - 1) : 0.0;
      return rate.last + 0.5 * (1.0 - rate.last) * (1.0 + std::cos(std::numbers::pi * share));
    }
  };
  return std::visit(Factor{epoch, epochs}, schedule);
}

}  // namespace strainwave::analysis::networks
