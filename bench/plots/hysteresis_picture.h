// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "analysis/torsional_stiffness.h"

namespace strainwave::bench {

/// One torsion loop as it is drawn: measured samples, fitted loop, and the three fitted slopes.
struct HysteresisCurve {
  std::string label;  // "cycle 1"
  std::span<const double> twist_rad;
  std::span<const double> torque_Nm;
  /// The fitted loop at the same samples; empty when the method fits none.
  std::span<const double> fitted_torque_Nm;
  analysis::TestTorques torques;
  analysis::Estimate k1_Nm_per_rad;  // NaN: the record does not hold it, and its line is left out
  analysis::Estimate k2_Nm_per_rad;
  analysis::Estimate k3_Nm_per_rad;
  /// Of the friction beside the spring; the slopes are drawn up to T₃ less this.
  double friction_torque_Nm{};
};

/// Torque over twist, with the fitted loop and the lines of K1–K3, whose values stand in the key. `last` is
/// laid over `first` in another colour. Writes `stem`.svg and `stem`.png.
///
/// @return the picture's path, as RenderPicture does.
/// @throws std::invalid_argument if a curve is empty or its columns differ in length.
/// @throws GnuplotError, std::filesystem::filesystem_error as RenderPicture does.
std::filesystem::path DrawHysteresis(const std::string& title, const HysteresisCurve& first,
                                     const std::optional<HysteresisCurve>& last,
                                     const std::filesystem::path& stem);

}  // namespace strainwave::bench
