// SPDX-License-Identifier: Apache-2.0
#include "analysis/series_compliance.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "analysis/arguments.h"
#include "analysis/linear_regression.h"
#include "analysis/units.h"

namespace strainwave::analysis {
namespace {

constexpr std::size_t kFewestBlankSamples = 16;

}  // namespace

BlankRamp FitSeriesCompliance(std::span<const double> torque_Nm, std::span<const double> twist_rad) {
  RequireSameLength("torque_Nm", torque_Nm, "twist_rad", twist_rad);
  RequireAtLeast("torque_Nm", torque_Nm, kFewestBlankSamples);
  RequireFinite("torque_Nm", torque_Nm);
  RequireFinite("twist_rad", twist_rad);
  const auto n = static_cast<Eigen::Index>(torque_Nm.size());
  Eigen::MatrixXd design(n, 2);
  design.col(0).setOnes();
  design.col(1) = Eigen::Map<const Eigen::VectorXd>(torque_Nm.data(), n);
  const LinearFit line =
      FitLinear(design, Eigen::Map<const Eigen::VectorXd>(twist_rad.data(), n), ErrorModel::kAutocorrelated);
  BlankRamp ramp;
  ramp.compliance.compliance_rad_per_Nm = {line.coefficients(1), line.StandardError(1)};
  ramp.rms_residual_rad = std::sqrt(line.residuals.squaredNorm() / static_cast<double>(n));
  if (line.rank < 2) {
    ramp.failed_checks.push_back("the torque does not change");
  } else if (line.coefficients(1) < 0.0) {
    ramp.failed_checks.push_back("twist falls with torque: a sign is swapped");
  }
  return ramp;
}

double EncoderError::At(double encoder_angle_rad) const {
  double error_rad = 0.0;
  for (const Harmonic* harmonic : {&once, &twice}) {
    error_rad +=
        harmonic->amplitude.value * std::cos(harmonic->order * encoder_angle_rad - harmonic->phase_rad.value);
  }
  return error_rad;
}

EncoderError FitEncoderError(std::span<const double> encoder_angle_rad,
                             std::span<const double> reference_angle_rad) {
  RequireSameLength("encoder_angle_rad", encoder_angle_rad, "reference_angle_rad", reference_angle_rad);
  RequireAtLeast("encoder_angle_rad", encoder_angle_rad, kFewestBlankSamples);
  RequireFinite("encoder_angle_rad", encoder_angle_rad);
  RequireFinite("reference_angle_rad", reference_angle_rad);
  const auto [low, high] = std::minmax_element(encoder_angle_rad.begin(), encoder_angle_rad.end());
  constexpr double kLeastShareOfTurn = 0.9;
  if (*high - *low < kLeastShareOfTurn * kTwoPi) {
    throw std::invalid_argument(fmt::format(
        "encoder_angle_rad covers {:.4g} deg (expected nine tenths of a turn)", DegFromRad(*high - *low)));
  }
  std::vector<double> excess_rad(encoder_angle_rad.size());
  for (std::size_t i = 0; i < excess_rad.size(); ++i) {
    excess_rad[i] = encoder_angle_rad[i] - reference_angle_rad[i];
  }
  const HarmonicFit fit = FitHarmonics(encoder_angle_rad, excess_rad, std::array{1.0, 2.0});
  return {fit.harmonics[0], fit.harmonics[1]};
}

}  // namespace strainwave::analysis
