// SPDX-License-Identifier: Apache-2.0
#include "analysis/model/vibration.h"

#include <algorithm>
#include <cmath>

namespace strainwave::analysis::model {

VibrationSources SourcesAt(const Vibration& vibration, const VibrationConditions& conditions,
                           const WearState& wear) noexcept {
  const double speed = std::abs(conditions.input_speed_rad_per_s) / vibration.reference_speed_rad_per_s;
  const double load = std::abs(conditions.output_torque_Nm) / vibration.reference_torque_Nm;
  const double warm = std::exp(0.006 * (conditions.temperature_degC - 40.0));
  const double r = wear.run_in;
  const double w = wear.tooth;
  const double f = wear.flexspline;
  const double g = wear.grease;

  const double shaft = speed * speed * (0.7 + 0.3 * load);
  const double mesh = speed * (0.35 + 0.65 * load) * (1.0 - 0.15 * r);
  const double rub = speed * (0.5 + 0.5 * std::sqrt(load)) * warm * (1.0 - 0.1 * r);
  const std::array<double, kVibrationOrders> factor{shaft * (1.0 + 0.15 * w + 0.2 * f * f),
                                                    shaft * (1.0 + 0.35 * std::pow(w, 1.3) + 0.15 * f),
                                                    shaft * (1.0 + 0.6 * w * w + 0.1 * g),
                                                    mesh * (1.0 + 0.8 * w + 0.3 * f),
                                                    mesh * (1.0 + 0.7 * std::pow(w, 1.5) + 0.25 * g),
                                                    mesh * (1.0 + 0.5 * w + 0.4 * f * f + 0.2 * g)};
  VibrationSources sources;
  for (std::size_t k = 0; k < kVibrationOrders; ++k) {
    sources.order_m_per_s2[k] = vibration.order_m_per_s2[k] * factor[k];
  }
  const std::array<double, kVibrationModes> rubbing{1.0 + 0.5 * w + 0.3 * g, 1.0 + 0.9 * g * g + 0.2 * w,
                                                    1.0 + 0.5 * f + 0.4 * g};
  const std::array<double, kVibrationModes> softening{0.03, 0.015, 0.025};
  for (std::size_t m = 0; m < kVibrationModes; ++m) {
    sources.mode_m_per_s2[m] = vibration.mode_m_per_s2[m] * rub * rubbing[m];
    sources.mode_Hz[m] = vibration.mode_Hz[m] * (1.0 - softening[m] * f);
  }
  sources.broadband_m_per_s2 = vibration.broadband_m_per_s2 * rub * (1.0 + 0.4 * g);
  sources.sideband_depth = vibration.sideband_depth * (1.0 + 0.8 * f + 0.2 * w);
  return sources;
}

double ChannelRms_m_per_s2(const Vibration& vibration, const VibrationSources& sources,
                           int channel) noexcept {
  const auto c = static_cast<std::size_t>(channel);
  double square = vibration.sensor_noise_m_per_s2 * vibration.sensor_noise_m_per_s2 +
                  sources.broadband_m_per_s2 * sources.broadband_m_per_s2;
  for (std::size_t k = 0; k < kVibrationOrders; ++k) {
    const double amplitude = vibration.order_gain[c][k] * sources.order_m_per_s2[k];
    square += 0.5 * amplitude * amplitude;
  }
  for (std::size_t m = 0; m < kVibrationModes; ++m) {
    const double deviation = vibration.mode_gain[c][m] * sources.mode_m_per_s2[m];
    square += deviation * deviation;
  }
  return std::sqrt(square);
}

double StrongestRms_m_per_s2(const Vibration& vibration, const VibrationSources& sources) noexcept {
  double strongest = 0.0;
  for (int channel = 0; channel < kVibrationChannels - 1; ++channel) {
    strongest = std::max(strongest, ChannelRms_m_per_s2(vibration, sources, channel));
  }
  return strongest;
}

}  // namespace strainwave::analysis::model
