// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/simulated/encoder_error.h"

#include <cmath>

namespace strainwave::bench {

EncoderError::EncoderError(const analysis::model::Encoder& encoder)
    : turn_error_rad_(
          [&](double angle_rad) { return analysis::model::EncoderTurnError_rad(encoder, angle_rad); }),
      interpolation_error_rad_(
          [&](double phase_rad) { return encoder.interpolation_rad * std::sin(phase_rad); }),
      grating_periods_per_turn_(encoder.grating_periods_per_turn),
      resolution_rad_(encoder.resolution_rad),
      inverse_resolution_per_rad_(encoder.resolution_rad > 0.0 ? 1.0 / encoder.resolution_rad : 0.0) {}

double EncoderError::Reading(double angle_rad, double noise_rad) const noexcept {
  const double turns = angle_rad * (1.0 / kTwoPi);
  const double reading = angle_rad + turn_error_rad_.At(turns) +
                         interpolation_error_rad_.At(turns * grating_periods_per_turn_) + noise_rad;
  if (resolution_rad_ == 0.0) return reading;
  return static_cast<double>(std::llrint(reading * inverse_resolution_per_rad_)) * resolution_rad_;
}

}  // namespace strainwave::bench
