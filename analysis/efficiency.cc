// SPDX-License-Identifier: Apache-2.0
#include "analysis/efficiency.h"

#include <fmt/format.h>

#include <cmath>

#include "analysis/arguments.h"
#include "analysis/autocorrelation.h"
#include "analysis/noise_level.h"

namespace strainwave::analysis {
namespace {

constexpr std::size_t kFewestSteadySamples = 8;

Estimate Mean(std::span<const double> values) {
  const auto n = static_cast<double>(values.size());
  double mean = 0.0;
  for (double value : values) {
    mean += value / n;
  }
  std::vector<double> residual;
  double square = 0.0;
  for (double value : values) {
    residual.push_back(value - mean);
    square += residual.back() * residual.back();
  }
  return {mean, std::sqrt(square / (n - 1.0) / n * VarianceInflation(residual))};
}

}  // namespace

Efficiency MeasureEfficiency(const SteadyRotation& rotation) {
  const struct {
    const char* name;
    std::span<const double> values;
  } channels[] = {{"input_torque_Nm", rotation.input_torque_Nm},
                  {"input_speed_rad_per_s", rotation.input_speed_rad_per_s},
                  {"output_torque_Nm", rotation.output_torque_Nm},
                  {"output_speed_rad_per_s", rotation.output_speed_rad_per_s}};
  for (const auto& channel : channels) {
    RequireSameLength(channel.name, channel.values, channels[0].name, channels[0].values);
    RequireAtLeast(channel.name, channel.values, kFewestSteadySamples);
    RequireFinite(channel.name, channel.values);
  }
  const Estimate input_torque = Mean(rotation.input_torque_Nm);
  const Estimate output_torque = Mean(rotation.output_torque_Nm);
  Efficiency result;
  result.input_power_W = input_torque.value * Mean(rotation.input_speed_rad_per_s).value;
  result.output_power_W = output_torque.value * Mean(rotation.output_speed_rad_per_s).value;
  result.back_driven = result.input_power_W < 0.0 && result.output_power_W < 0.0;
  if (result.input_power_W > 0.0 && result.output_power_W < 0.0) {
    result.failed_checks.push_back("power flows into the gear on both sides: a sign is swapped");
  }
  if (result.input_power_W < 0.0 && result.output_power_W > 0.0) {
    result.failed_checks.push_back("power flows out of the gear on both sides: a sign is swapped");
  }
  const double forward = result.output_power_W / result.input_power_W;
  const double value = result.back_driven ? 1.0 / forward : forward;
  const double relative = std::hypot(input_torque.standard_error / input_torque.value,
                                     output_torque.standard_error / output_torque.value);
  result.efficiency = {value, std::abs(value) * relative};
  if (value > 1.0) {
    result.failed_checks.push_back(
        fmt::format("more power comes out than goes in: efficiency {:.4g}", value));
  }
  if (!std::isfinite(value)) {
    result.failed_checks.push_back("no power goes in");
  }
  return result;
}

std::optional<Estimate> MeasureStartingTorque(std::span<const double> torque_Nm,
                                              std::span<const double> speed_rad_per_s,
                                              double speed_threshold_rad_per_s) {
  RequireSameLength("torque_Nm", torque_Nm, "speed_rad_per_s", speed_rad_per_s);
  RequireAtLeast("torque_Nm", torque_Nm, kFewestSteadySamples);
  RequireFinite("torque_Nm", torque_Nm);
  RequireFinite("speed_rad_per_s", speed_rad_per_s);
  RequirePositive("speed_threshold_rad_per_s", speed_threshold_rad_per_s);
  const auto moves = [&](std::size_t i, double sign) {
    return sign * speed_rad_per_s[i] > speed_threshold_rad_per_s;
  };
  for (std::size_t i = 0; i + 2 < speed_rad_per_s.size(); ++i) {
    const double sign = speed_rad_per_s[i] > 0.0 ? 1.0 : -1.0;
    if (!moves(i, sign) || !moves(i + 1, sign) || !moves(i + 2, sign)) {
      continue;
    }
    const double before_Nm = torque_Nm[i > 0 ? i - 1 : 0];
    const double noise_Nm = EstimateNoise(torque_Nm).standard_deviation;
    return Estimate{0.5 * (before_Nm + torque_Nm[i]),
                    std::hypot(noise_Nm / std::sqrt(2.0), 0.5 * (torque_Nm[i] - before_Nm))};
  }
  return std::nullopt;
}

}  // namespace strainwave::analysis
