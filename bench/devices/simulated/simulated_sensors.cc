// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/simulated/simulated_sensors.h"

#include <algorithm>
#include <cmath>

#include "analysis/units.h"

namespace strainwave::bench {

namespace model = analysis::model;

namespace {

constexpr double kMotorReference_degC = 20.0;

double Square(double value) noexcept { return value * value; }

}  // namespace

SimulatedSensors::SimulatedSensors(const model::PlantParameters& specimen, double time_skew_s)
    : transducer_(specimen.transducer),
      slow_noise_(specimen.noise),
      servo_(specimen.servo),
      vibration_(specimen.vibration),
      inverse_reference_speed_s_per_rad_(1.0 / specimen.vibration.reference_speed_rad_per_s),
      input_noise_rad_(specimen.input_encoder.noise_rad),
      output_noise_rad_(specimen.output_encoder.noise_rad),
      input_encoder_(specimen.input_encoder),
      output_encoder_(specimen.output_encoder),
      time_skew_s_(time_skew_s),
      drift_(specimen.output_drift),
      defect_square_(model::SquaresAt(specimen.vibration_causes, specimen.vibration.reference_speed_rad_per_s,
                                      specimen.ratio)),
      has_drift_(drift_.moves()) {}

void SimulatedSensors::FollowVibration(const GearPlant& plant) noexcept {
  const PlantState& state = plant.state();
  const model::VibrationSources at_reference = model::SourcesAt(
      vibration_, {vibration_.reference_speed_rad_per_s, state.gear_torque_Nm, state.thermal.gear_degC},
      state.wear);
  double strongest = -1.0;
  for (std::size_t c = 0; c + 1 < model::kVibrationChannels; ++c) {
    double shaft = 0.0;
    double mesh = Square(at_reference.broadband_m_per_s2);
    for (std::size_t k = 0; k < model::kVibrationOrders; ++k) {
      (k < 3 ? shaft : mesh) += 0.5 * Square(vibration_.order_gain[c][k] * at_reference.order_m_per_s2[k]);
    }
    for (std::size_t m = 0; m < model::kVibrationModes; ++m) {
      mesh += Square(vibration_.mode_gain[c][m] * at_reference.mode_m_per_s2[m]);
    }
    shaft += Square(vibration_.order_gain[c][0]) * defect_square_.fourth;
    mesh += Square(vibration_.mode_gain[c][0]) * defect_square_.second;
    if (shaft + mesh <= strongest) continue;
    strongest = shaft + mesh;
    vibration_square_ = {shaft, mesh, Square(vibration_.sensor_noise_m_per_s2)};
  }
}

Readings SimulatedSensors::Measure(const GearPlant& plant, std::chrono::nanoseconds time) noexcept {
  const PlantState& state = plant.state();
  Readings readings;
  readings.time = time;
  readings.SetSampleTimes(time);
  readings.input_angle_rad = input_encoder_.Reading(state.input_rad, input_noise_rad_ * noise_());
  const double late_rad = time_skew_s_ * state.output_speed_rad_per_s;
  double beside_rad = output_noise_rad_ * noise_();
  if (has_drift_) {
    beside_rad += model::OutputDrift_rad(drift_, state.thermal.gear_degC, plant.measurement_time_s());
  }
  readings.output_angle_rad = output_encoder_.Reading(state.output_rad + late_rad, beside_rad);
  readings.input_speed_rad_per_s = state.input_speed_rad_per_s + slow_noise_.speed_rad_per_s * noise_();
  readings.output_torque_Nm =
      model::TransducerReading_Nm(transducer_, state.gear_torque_Nm + (shunted_ ? transducer_.shunt_Nm : 0.0),
                                  state.thermal.housing_degC, state.time_s / kDay_s) +
      transducer_.noise_Nm * noise_();
  // The drive knows its current, and takes the torque constant for that of a cold motor.
  const double warm = 1.0 + servo_.kt_per_K * (state.thermal.motor_degC - kMotorReference_degC);
  readings.motor_torque_Nm = state.motor_torque_Nm / warm + slow_noise_.motor_torque_Nm * noise_();
  readings.motor_torque_Nm += servo_.current_offset_Nm * plant.electrical_sine();
  readings.gear_temperature_degC = state.thermal.gear_degC + slow_noise_.temperature_K * noise_();
  readings.ambient_temperature_degC = plant.room_degC() + slow_noise_.temperature_K * noise_();
  const double speed = Square(state.input_speed_rad_per_s * inverse_reference_speed_s_per_rad_);
  const double level =
      std::sqrt((vibration_square_[0] * speed + vibration_square_[1]) * speed + vibration_square_[2]);
  readings.vibration_rms_m_per_s2 = std::max(0.0, level * (1.0 + slow_noise_.vibration_share * noise_()));
  return readings;
}

}  // namespace strainwave::bench
