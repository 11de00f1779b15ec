// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/sensor_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace strainwave::daq::acquisition {
namespace {

constexpr std::size_t kLeastResults = 3;
constexpr double kHundredYearsInDays = 36525;
constexpr double kSigmas = 2;

const char* NameOf(CheckKind kind) {
  switch (kind) {
    case CheckKind::kZero:
      return "zero check";
    case CheckKind::kShunt:
      return "shunt check";
    case CheckKind::kReference:
      return "reference check";
  }
  return "";
}

}  // namespace

CheckResult JudgeCheck(CheckKind kind, std::span<const double> values, const CheckLimits& limits) {
  CheckResult result{.kind = kind};
  const auto fail = [&result, kind](std::string why) {
    result.reason = fmt::format("{}: {}", NameOf(kind), why);
    return result;
  };
  if (values.size() < 2) return fail(fmt::format("{} values are too few to judge", values.size()));
  if (!std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); })) {
    return fail("a value is not a number");
  }
  const auto count = static_cast<double>(values.size());
  for (const double value : values) result.mean += value / count;
  double squares = 0;
  for (const double value : values) squares += (value - result.mean) * (value - result.mean);
  result.deviation = std::sqrt(squares / (count - 1));
  result.standard_error = result.deviation / std::sqrt(count);
  if (result.deviation > limits.most_noise) {
    return fail(fmt::format("the values scatter by {:.4g}, more than {:.4g}: something moves",
                            result.deviation, limits.most_noise));
  }
  if (std::abs(result.mean - limits.expected) > limits.allowed) {
    return fail(fmt::format("{:.6g} is further than {:.4g} from {:.6g}", result.mean, limits.allowed,
                            limits.expected));
  }
  result.passed = true;
  return result;
}

std::optional<CheckTrend> TrendOf(std::span<const EarlierCheck> checks, const CheckLimits& limits) {
  if (checks.size() < kLeastResults) return std::nullopt;
  const auto count = static_cast<double>(checks.size());
  double mean_time = 0, mean = 0;
  for (const EarlierCheck& check : checks) {
    mean_time += check.time_days / count;
    mean += check.mean / count;
  }
  double spread = 0, product = 0;
  for (const EarlierCheck& check : checks) {
    spread += (check.time_days - mean_time) * (check.time_days - mean_time);
    product += (check.time_days - mean_time) * (check.mean - mean);
  }
  if (!(spread > 0)) return std::nullopt;
  CheckTrend trend{.slope_per_day = product / spread};
  double squares = 0;
  for (const EarlierCheck& check : checks) {
    const double residual = check.mean - mean - trend.slope_per_day * (check.time_days - mean_time);
    squares += residual * residual;
  }
  trend.residual = std::sqrt(squares / (count - 2));
  trend.slope_standard_error = trend.residual / std::sqrt(spread);
  if (std::abs(trend.slope_per_day) <= kSigmas * trend.slope_standard_error || trend.slope_per_day == 0)
    return trend;
  const double now = mean + trend.slope_per_day * (checks.back().time_days - mean_time);
  const double limit = limits.expected + std::copysign(limits.allowed, trend.slope_per_day);
  const double days = std::max(0.0, (limit - now) / trend.slope_per_day);
  if (days <= kHundredYearsInDays) trend.days_left = days;
  return trend;
}

}  // namespace strainwave::daq::acquisition
