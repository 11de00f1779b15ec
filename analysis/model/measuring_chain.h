// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>

#include "analysis/units.h"

namespace strainwave::analysis::model {

/// Harmonics of an angle encoder's error over one turn, beyond eccentricity and tilt.
inline constexpr std::array<int, 4> kEncoderOrders{3, 5, 8, 13};

/// Angle encoder (docs/effects.md E18): reading = θ + eccentricity (1 per turn) + tilt (2 per turn) +
/// graduation error + interpolation error (once per grating period), quantised, with white noise.
struct Encoder {
  double eccentricity_rad{};
  double eccentricity_phase_rad{};
  double tilt_rad{};
  double tilt_phase_rad{};
  std::array<double, kEncoderOrders.size()> graduation_rad{};
  std::array<double, kEncoderOrders.size()> graduation_phase_rad{0.9, 3.3, 5.1, 1.7};
  double interpolation_rad{};
  double grating_periods_per_turn{16384.0};
  double resolution_rad{};
  double noise_rad{};
};

/// Output encoder: system accuracy ±2.5 arcsec (graduation and tilt), a few arcsec of eccentricity from its
/// mounting, 28 bits.
inline Encoder DefaultOutputEncoder() noexcept {
  Encoder encoder;
  encoder.eccentricity_rad = RadFromArcsec(3.0);
  encoder.eccentricity_phase_rad = 1.1;
  encoder.tilt_rad = RadFromArcsec(1.0);
  encoder.tilt_phase_rad = 2.6;
  encoder.graduation_rad = {RadFromArcsec(0.45), RadFromArcsec(0.25), RadFromArcsec(0.15),
                            RadFromArcsec(0.1)};
  encoder.interpolation_rad = RadFromArcsec(0.12);
  encoder.resolution_rad = kTwoPi / 268435456.0;
  encoder.noise_rad = RadFromArcsec(0.1);
  return encoder;
}

/// Encoder at the motor shaft: 24 bits. Its own error counts 1/80 at the output, but fully in a blank test at
/// 1:1, for which it is a calibrated one.
inline Encoder DefaultInputEncoder() noexcept {
  Encoder encoder;
  encoder.eccentricity_rad = RadFromArcsec(0.4);
  encoder.resolution_rad = kTwoPi / 16777216.0;
  encoder.noise_rad = RadFromArcsec(0.3);
  return encoder;
}

/// The part of an encoder's error that repeats every turn, without the interpolation error.
inline double EncoderTurnError_rad(const Encoder& encoder, double angle_rad) noexcept {
  double error = encoder.eccentricity_rad * std::sin(angle_rad + encoder.eccentricity_phase_rad) +
                 encoder.tilt_rad * std::sin(2.0 * angle_rad + encoder.tilt_phase_rad);
  for (std::size_t i = 0; i < kEncoderOrders.size(); ++i) {
    error +=
        encoder.graduation_rad[i] * std::sin(kEncoderOrders[i] * angle_rad + encoder.graduation_phase_rad[i]);
  }
  return error;
}

/// Torque transducer ±100 Nm, ±0.3 % before calibration.
struct TorqueTransducer {
  double gain_error{0.0};      // of this bench; drawn with `gain_error_sd` for each seed
  double gain_error_sd{5e-4};  // left after calibration
  double nonlinearity{2e-4};   // share of full scale, shape x − x³
  double full_scale_Nm{100.0};
  double zero_drift_Nm_per_K{0.004};
  double zero_drift_reference_degC{22.0};
  double noise_Nm{0.02};
  double zero_offset_Nm{};  // shown at no torque, at the reference temperature
  // Ageing since the bench was built; none on a nominal one.
  double zero_creep_Nm_per_day{};
  double gain_creep_per_day{};
  double shunt_Nm{50.0};  // what its shunt resistor adds to the bridge's signal, by the certificate
};

/// What the transducer shows without noise. A shunt adds to the torque: both pass the same amplifier.
inline double TransducerReading_Nm(const TorqueTransducer& transducer, double torque_Nm,
                                   double temperature_degC, double age_days = 0.0) noexcept {
  const double x = torque_Nm / transducer.full_scale_Nm;
  return torque_Nm * (1.0 + transducer.gain_error + transducer.gain_creep_per_day * age_days) +
         transducer.zero_creep_Nm_per_day * age_days +
         transducer.nonlinearity * transducer.full_scale_Nm * (x - x * x * x) +
         transducer.zero_drift_Nm_per_K * (temperature_degC - transducer.zero_drift_reference_degC) +
         transducer.zero_offset_Nm;
}

/// White noise of the slower channels, one standard deviation.
struct SlowChannelNoise {
  double speed_rad_per_s{0.05};
  double motor_torque_Nm{0.005};
  double temperature_K{0.03};
  double vibration_share{0.03};  // of the level
};

}  // namespace strainwave::analysis::model
