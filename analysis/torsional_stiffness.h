// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/transmission_error.h"

namespace strainwave::analysis {

/// Output torques of the test: the knees T₁ and T₂ from the gear's data sheet, and the peak T₃.
/// 0 < t1 < t2 < t3.
struct TestTorques {
  double t1_Nm{};
  double t2_Nm{};
  double t3_Nm{};
  double rated_Nm{};  // for the lost motion; 0: T₃ stands for it
};

/// A torsion loop, sample by sample in time order. The input is locked; the twist is the output angle.
struct TorsionLoop {
  std::span<const double> time_s;
  std::span<const double> torque_Nm;
  std::span<const double> twist_rad;
};

/// The three ways of docs/contract.md#stiffness.
enum class StiffnessMethod { kModel, kLoading, kBackbone };
inline constexpr std::array kStiffnessMethods{StiffnessMethod::kModel, StiffnessMethod::kLoading,
                                              StiffnessMethod::kBackbone};
/// "model", "loading", "backbone".
std::string_view NameOf(StiffnessMethod method);

/// Bench compliance in series with the gear (docs/effects.md E17): output twist that the couplings and the
/// sensor add per newton-metre, measured by a blank test. Zero when the encoder sees the gear alone.
struct SeriesCompliance {
  Estimate compliance_rad_per_Nm;
};

/// Slopes of the three segments, seen from the output, and the width of the loop. A slope that the record
/// does not hold is NaN, and a failed check says so.
struct TorsionalStiffness {
  Estimate k1_Nm_per_rad;       // up to T₁
  Estimate k2_Nm_per_rad;       // T₁ to T₂
  Estimate k3_Nm_per_rad;       // T₂ to T₃
  Estimate hysteresis_rad;      // width of the loop at zero torque
  Estimate lost_motion_rad;     // width of the loop's mid-line between ±4 % of rated torque
  double friction_torque_Nm{};  // model: the element's, 0 where none shows; backbone: half the loop's height
  double yield_twist_rad{};     // model only
  double rms_residual_Nm{};     // model only
  double noise_Nm{};            // model only: of both signals, from neighbouring samples
  /// The fitted loop at the record's samples (model only), for pictures.
  std::vector<double> fitted_torque_Nm;
  /// Checks that did not hold, in words; a number with a failed check is not to be stored as good.
  std::vector<std::string> failed_checks;
  /// What a reader of the numbers should know though they stand: sentences.
  std::vector<std::string> warnings;
};

/// Fits to the whole record
///
///   T = g(φ − φ₀) + z,   dz = (W/δ) dφ held within ±W,
///
/// where g is odd, continuous and piecewise linear with slopes K₁, K₂, K₃ and breaks where the spring's own
/// torque is ±T₁ and ±T₂, and z is one elasto-plastic element of friction torque W and yield twist δ. Free
/// are K₁, K₂, K₃, W, δ, φ₀ and the element's state at the first sample. The element is driven by the twist
/// made monotone between reversals, since the noise of the raw twist would ratchet it. Outliers lose weight
/// (Huber, three standard deviations). The standard errors hold under autocorrelated and uneven noise
/// (analysis/linear_regression.h, SandwichCovariance). A check fails where the model leaves far more than the
/// noise, and more than another form of friction would.
///
/// Limit: a signal made monotone runs outward at its reversals by a part of its noise. Where a sample's step
/// is about as large as the noise, K3 comes out some 1e-4 high, up to half its standard error, and its 95 %
/// interval holds the truth in about 90 % of the cases.
///
/// @param loop     at least 16 samples; one loop or several, starting anywhere.
/// @throws std::invalid_argument if lengths differ, a value is not finite, there are fewer than 16 samples,
///   or the torques are out of order.
TorsionalStiffness FitStiffnessModel(const TorsionLoop& loop, const TestTorques& torques);

/// As published (docs/sources.md#shivam-2023, eq. 4): secants of the loading branch from its start at zero
/// torque to T₁, T₂ and T₃. The branch is the record's first one that goes from zero torque to T₃ (to −T₃ if
/// none does); a record that stops up to 2 % short of T₃ is taken to its end. On the way from zero the
/// friction element still winds up, or has shifted the breaks by its torque W: K₁ of a first loading comes
/// out high, K₂ and K₃ a few per cent low. Arguments and errors as FitStiffnessModel.
TorsionalStiffness FitStiffnessLoading(const TorsionLoop& loop, const TestTorques& torques);

/// Mid-line of loading and unloading branch without the segment after each reversal where friction still
/// sticks: both branches moved by half the loop's height W onto the line between them, and the twist
/// regressed on the parts of that torque below T₁, between T₁ and T₂, and above T₂. The length of the segment
/// is read off the record: up to where its samples have come within 5 % of the loop's height (or the noise)
/// of the mid-line of all others. Arguments and errors as FitStiffnessModel.
TorsionalStiffness FitStiffnessBackbone(const TorsionLoop& loop, const TestTorques& torques);

/// The stiffness of the gear alone by one of the methods: takes the bench's compliance C out of the twist
/// (φ − C·T, so that 1/K = 1/K_measured − C and the breaks are those of the gear) and adds to the standard
/// errors those of C (by a second fit at C + its standard error) and of the transducer's calibration, in
/// quadrature. Where model and backbone part by more than their errors, the friction is not one element: the
/// model's errors then hold that misfit of form as well, and a warning gives both numbers.
///
/// @param torque_gain_relative_se  relative standard error of the torque transducer's gain (0.003 / √3 for
///   ±0.3 % read as a rectangular distribution), from 0 up.
/// @throws std::invalid_argument as FitStiffnessModel, and if C, its error or the gain's error is negative.
TorsionalStiffness MeasureStiffness(const TorsionLoop& loop, const TestTorques& torques,
                                    StiffnessMethod method, const SeriesCompliance& bench = {},
                                    double torque_gain_relative_se = 0.0);

}  // namespace strainwave::analysis
