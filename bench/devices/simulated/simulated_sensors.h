// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "bench/devices/simulated/encoder_error.h"
#include "bench/devices/simulated/gear_plant.h"
#include "bench/devices/simulated/noise_source.h"
#include "bench/roles/sampler.h"

namespace strainwave::bench {

/// The slow channels: what encoders, transducer, drive and thermometers show of the plant.
class SimulatedSensors {
 public:
  SimulatedSensors(const analysis::model::PlantParameters& specimen, double time_skew_s);

  /// One reading of every channel. Draws noise.
  Readings Measure(const GearPlant& plant, std::chrono::nanoseconds time) noexcept;

  /// The vibration level follows wear, load and temperature only as often as this is called.
  void FollowVibration(const GearPlant& plant) noexcept;
  /// The shunt resistor across the bridge of the torque transducer.
  void ConnectShunt(bool on) noexcept { shunted_ = on; }
  bool shunted() const noexcept { return shunted_; }
  void SeedNoise(std::uint64_t key) noexcept { noise_ = NoiseSource(key); }

 private:
  analysis::model::TorqueTransducer transducer_;
  analysis::model::SlowChannelNoise slow_noise_;
  analysis::model::DrivingServo servo_;
  analysis::model::Vibration vibration_;
  double inverse_reference_speed_s_per_rad_;
  double input_noise_rad_;
  double output_noise_rad_;
  EncoderError input_encoder_;
  EncoderError output_encoder_;
  double time_skew_s_;
  analysis::model::OutputDrift drift_;
  analysis::model::CauseSquares defect_square_;  // at the reference speed
  bool has_drift_;
  bool shunted_{};
  NoiseSource noise_;
  // Mean square of the strongest channel by power of the speed (relative to the reference): 4, 2, 0.
  std::array<double, 3> vibration_square_{};
};

}  // namespace strainwave::bench
