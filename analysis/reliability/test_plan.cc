// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/test_plan.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/special_functions/beta.hpp>

#include "analysis/arguments.h"

namespace strainwave::analysis::reliability {
namespace {

void RequireBetween(const char* name, double value) {
  if (!(value > 0.0 && value < 1.0))
    throw std::invalid_argument(fmt::format("{} = {} is not between 0 and 1", name, value));
}

void RequireSound(const Demonstration& wanted, int units) {
  RequireBetween("share_failed", wanted.share_failed);
  RequireBetween("confidence", wanted.confidence);
  RequirePositive("shape", wanted.shape);
  if (wanted.failures_allowed < 0)
    throw std::invalid_argument(
        fmt::format("failures_allowed = {} is not a number from 0 up", wanted.failures_allowed));
  if (units <= wanted.failures_allowed)
    throw std::invalid_argument(
        fmt::format("units = {} is not more than failures_allowed = {}", units, wanted.failures_allowed));
}

// T/t.
double TimesTheLife(const Demonstration& wanted, int units) {
  // The share that fails by the end, at which so few fail with the chance 1 − C.
  const double share = boost::math::ibeta_inv(
      wanted.failures_allowed + 1.0, static_cast<double>(units - wanted.failures_allowed), wanted.confidence);
  return std::pow(std::log1p(-share) / std::log1p(-wanted.share_failed), 1.0 / wanted.shape);
}

}  // namespace

double TestTimeToShow(const Demonstration& wanted, int units) {
  RequireSound(wanted, units);
  RequirePositive("life", wanted.life);
  return wanted.life * TimesTheLife(wanted, units);
}

std::optional<int> UnitsToShow(const Demonstration& wanted, double time, int most) {
  RequirePositive("time", time);
  int low = wanted.failures_allowed;  // too few
  int high = most;
  if (TestTimeToShow(wanted, high) > time) return std::nullopt;
  while (high - low > 1) {
    const int middle = low + (high - low) / 2;
    (TestTimeToShow(wanted, middle) > time ? low : high) = middle;
  }
  return high;
}

double LifeShown(const Demonstration& wanted, int units, double time) {
  RequireSound(wanted, units);
  RequirePositive("time", time);
  return time / TimesTheLife(wanted, units);
}

double ChanceToPass(const Demonstration& wanted, int units, double time, double true_life) {
  RequireSound(wanted, units);
  RequirePositive("time", time);
  RequirePositive("true_life", true_life);
  const double hazard = -std::log1p(-wanted.share_failed) * std::pow(time / true_life, wanted.shape);
  return boost::math::cdf(boost::math::binomial(units, -std::expm1(-hazard)), wanted.failures_allowed);
}

}  // namespace strainwave::analysis::reliability
