// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "analysis/model/measuring_chain.h"
#include "bench/devices/simulated/turn_table.h"

namespace strainwave::bench {

/// What an encoder shows: its error over the turn from a table, exact to 1e-4 of the error.
class EncoderError {
 public:
  explicit EncoderError(const analysis::model::Encoder& encoder);

  /// The quantised reading at this angle with this noise.
  double Reading(double angle_rad, double noise_rad) const noexcept;

 private:
  TurnTable turn_error_rad_;
  TurnTable interpolation_error_rad_;  // over one grating period
  double grating_periods_per_turn_;
  double resolution_rad_;
  double inverse_resolution_per_rad_;
};

}  // namespace strainwave::bench
