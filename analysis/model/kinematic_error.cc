// SPDX-License-Identifier: Apache-2.0
#include "analysis/model/kinematic_error.h"

#include <cmath>

namespace strainwave::analysis::model {

KinematicSeries CompileKinematicError(const KinematicError& error, double ratio) {
  KinematicSeries series;
  const double per_output = 1.0 / ratio;
  series.inverse_ratio = per_output;
  series.order = {1.0, 2.0, 4.0, 2.0 + 2.0 * per_output, per_output, 2.0 * per_output};
  for (std::size_t k = 0; k < kKinematicOrders; ++k) {
    series.sine_rad[k] = error.amplitude_rad[k] * std::cos(error.phase_rad[k]);
    series.cosine_rad[k] = error.amplitude_rad[k] * std::sin(error.phase_rad[k]);
  }
  return series;
}

double KinematicErrorAt(const KinematicSeries& series, double input_rad) noexcept {
  const GearPhasors phasors = PhasorsAt(input_rad, series.inverse_ratio);
  return EvaluateKinematicError(series, phasors, HarmonicsOf(phasors)).error_rad;
}

}  // namespace strainwave::analysis::model
