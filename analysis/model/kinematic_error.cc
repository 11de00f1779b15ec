// SPDX-License-Identifier: Apache-2.0
#include "analysis/model/kinematic_error.h"

#include <cmath>

namespace strainwave::analysis::model {

KinematicSeries CompileKinematicError(const KinematicError& error, double ratio) {
  KinematicSeries series;
  const double per_output = 1.0 / ratio;
  series.inverse_ratio = per_output;
  series.damage = error.damage;
  series.order = {1.0, 2.0, 4.0, 2.0 + 2.0 * per_output, per_output, 2.0 * per_output};
  for (std::size_t k = 0; k < kKinematicOrders; ++k) {
    series.sine_rad[k] = error.amplitude_rad[k] * std::cos(error.phase_rad[k]);
    series.cosine_rad[k] = error.amplitude_rad[k] * std::sin(error.phase_rad[k]);
  }
  return series;
}

KinematicValue EvaluateDamagedKinematicError(const KinematicSeries& series, const GearPhasors& phasors,
                                             const InputHarmonics& harmonics) noexcept {
  KinematicValue value = EvaluateKinematicError(series, phasors, harmonics);
  const LocalToothDamage& damage = series.damage;
  if (damage.height_rad == 0.0) return value;
  const double output_rad = std::atan2(phasors.output_sin, phasors.output_cos);
  const double bump_rad = damage.height_rad * LocalToothDamageShape(output_rad, damage.centre_rad,
                                                                    damage.width_rad, damage.skew_share);
  // Slope of a Gaussian: −(distance / deviation²) of its value.
  const double away_rad = std::remainder(output_rad - damage.centre_rad, kTwoPi);
  const double flank = away_rad < 0.0 ? 1.0 - damage.skew_share : 1.0 + damage.skew_share;
  const double per_width = kWidthPerDeviation / (damage.width_rad * flank);
  value.error_rad += bump_rad;
  value.derivative -= bump_rad * away_rad * per_width * per_width * series.inverse_ratio;
  return value;
}

double KinematicErrorAt(const KinematicSeries& series, double input_rad) noexcept {
  const GearPhasors phasors = PhasorsAt(input_rad, series.inverse_ratio);
  return EvaluateDamagedKinematicError(series, phasors, HarmonicsOf(phasors)).error_rad;
}

}  // namespace strainwave::analysis::model
