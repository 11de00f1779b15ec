// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "analysis/model/vibration_causes.h"
#include "analysis/model/wear.h"

namespace strainwave::analysis::model {

/// Accelerometers: x, y and z on the drive, and z on the motor.
inline constexpr int kVibrationChannels = 4;
/// Orders whose amplitude is kept by its own: 1, 2 and 4 per input turn, the tooth engagement at 2.025, and
/// the tooth mesh at 160 and 162 per input turn.
inline constexpr int kVibrationOrders = 6;
enum class VibrationOrder : unsigned { kInput1, kInput2, kInput4, kTooth, kMesh160, kMesh162 };
/// Resonances of housing and flexspline that mesh impacts and friction noise excite.
inline constexpr int kVibrationModes = 3;

/// Vibration at 2400 rpm, 40 Nm and 40 °C, new gear. Levels are general knowledge [K] about a gear "of low
/// vibration" (docs/sources.md#shivam-2023): some tenths to one m/s².
struct Vibration {
  std::array<double, kVibrationOrders> order_m_per_s2{0.20, 0.36, 0.10, 0.09, 0.26, 0.20};
  std::array<double, kVibrationModes> mode_m_per_s2{0.34, 0.26, 0.18};  // standard deviation
  std::array<double, kVibrationModes> mode_Hz{830.0, 2350.0, 5400.0};
  std::array<double, kVibrationModes> mode_damping{0.03, 0.02, 0.015};
  double broadband_m_per_s2{0.05};
  double sensor_noise_m_per_s2{0.01};
  double sideband_depth{0.25};     // of the mesh, at two per input turn
  double output_modulation{0.15};  // of the mesh, at one per output turn
  double sensor_drift{0.02};       // slow change of a sensor's sensitivity, standard deviation
  double scatter_per_run{0.03};    // of each source, from one measurement to the next
  double reference_speed_rad_per_s{251.327412287};  // 2400 rpm
  double reference_torque_Nm{40.0};
  /// Share of each source that each channel sees; drawn for each specimen (docs/effects.md E25).
  std::array<std::array<double, kVibrationOrders>, kVibrationChannels> order_gain{
      {{1.0, 0.8, 0.7, 0.9, 0.8, 0.9},
       {0.8, 1.0, 0.9, 0.8, 1.0, 0.8},
       {0.6, 0.7, 1.0, 1.0, 0.9, 1.0},
       {1.2, 0.6, 0.5, 0.5, 0.3, 0.3}}};
  std::array<std::array<double, kVibrationModes>, kVibrationChannels> mode_gain{
      {{1.0, 0.6, 0.4}, {0.7, 1.0, 0.5}, {0.5, 0.8, 1.0}, {0.4, 0.3, 0.2}}};
  std::array<std::array<double, kVibrationOrders>, kVibrationChannels> order_phase_rad{};
};

struct VibrationConditions {
  double input_speed_rad_per_s{};
  double output_torque_Nm{};
  double temperature_degC{};
};

/// Amplitudes of the sources at one operating point and state of wear.
struct VibrationSources {
  std::array<double, kVibrationOrders> order_m_per_s2{};
  std::array<double, kVibrationModes> mode_m_per_s2{};
  std::array<double, kVibrationModes> mode_Hz{};
  double broadband_m_per_s2{};
  double sideband_depth{};
};

/// Orders of the shaft rise with the speed squared, mesh and friction noise with speed and load; grease damps
/// when cold. Wear raises all of them, each by its own mixture of the hidden states.
VibrationSources SourcesAt(const Vibration& vibration, const VibrationConditions& conditions,
                           const WearState& wear) noexcept;

/// RMS of one channel that these sources add up to.
double ChannelRms_m_per_s2(const Vibration& vibration, const VibrationSources& sources, int channel) noexcept;

/// RMS of the strongest channel on the drive.
double StrongestRms_m_per_s2(const Vibration& vibration, const VibrationSources& sources) noexcept;

}  // namespace strainwave::analysis::model
