// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/harmonic_regression.h"
#include "analysis/torsional_stiffness.h"

namespace strainwave::analysis {

/// What the blank test says: the bench with a rigid shaft in the gear's place (docs/requirements.md R43).
struct BlankRamp {
  SeriesCompliance compliance;
  double rms_residual_rad{};
  /// Checks that did not hold, in words.
  std::vector<std::string> failed_checks;
};

/// Straight line twist = C · torque + offset through a torque ramp. The standard error holds under
/// autocorrelated residuals, so that a slightly bent or looped line costs certainty.
/// @throws std::invalid_argument if lengths differ, a value is not finite, or there are fewer than 16
///   samples.
BlankRamp FitSeriesCompliance(std::span<const double> torque_Nm, std::span<const double> twist_rad);

/// Error of the output encoder by its own angle: eccentricity once, tilt twice a turn (docs/effects.md E18).
struct EncoderError {
  Harmonic once;  // amplitude in rad
  Harmonic twice;

  /// What the encoder reads too much at an angle.
  double At(double encoder_angle_rad) const;
};

/// From a turn of the blank: encoder angle less the angle of a reference on the same rigid shaft. The
/// constant between the two is fitted and left out.
/// @throws std::invalid_argument if lengths differ, a value is not finite, there are fewer than 16 samples,
/// or they cover less
///   than nine tenths of a turn.
EncoderError FitEncoderError(std::span<const double> encoder_angle_rad,
                             std::span<const double> reference_angle_rad);

}  // namespace strainwave::analysis
