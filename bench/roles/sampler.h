// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace strainwave::bench {

/// The slow channels of the bench, one value each a control period: the newest of each, whose moments differ.
/// What puts two beside each other while the shafts turn takes both from `SampleAlignment`. Angles are those
/// of the two measuring encoders: at the motor shaft and at the reducer's output.
struct Readings {
  std::chrono::nanoseconds time{};
  // When each was sampled: they come from devices of their own, of which one may be late.
  std::chrono::nanoseconds input_angle_time{};
  std::chrono::nanoseconds output_angle_time{};
  std::chrono::nanoseconds input_speed_time{};
  std::chrono::nanoseconds torque_time{};  // of the output
  std::chrono::nanoseconds motor_torque_time{};
  double input_angle_rad{};
  double output_angle_rad{};
  double input_speed_rad_per_s{};
  double output_torque_Nm{};
  double motor_torque_Nm{};  // from the motor current
  double gear_temperature_degC{};
  double ambient_temperature_degC{};
  double vibration_rms_m_per_s2{};  // over the last tenth of a second, strongest axis
  /// Bit n set: channel n of `Channel` gave no fresh, plausible value this period.
  unsigned bad_channels{};
  bool quick_stop_pressed{};  // the operator's key, where the bench has one

  /// Of the older of the two angles.
  std::chrono::nanoseconds angles_time() const noexcept {
    return std::min(input_angle_time, output_angle_time);
  }
  void SetSampleTimes(std::chrono::nanoseconds sampled) noexcept {
    input_angle_time = output_angle_time = input_speed_time = torque_time = motor_torque_time = sampled;
  }
};

/// Number and order of the slow channels, as in `Readings::bad_channels`.
enum class Channel : unsigned {
  kInputAngle,
  kOutputAngle,
  kInputSpeed,
  kOutputTorque,
  kMotorTorque,
  kGearTemperature,
  kAmbientTemperature,
  kVibrationRms,
};

/// The accelerometers, in the order of VibrationBlock.
inline constexpr std::array kAccelerometers{"accel_x", "accel_y", "accel_z", "accel_motor_z"};

/// Samples of the accelerometers since the last call, all of one length.
struct VibrationBlock {
  std::vector<float> accel_x_m_per_s2;
  std::vector<float> accel_y_m_per_s2;
  std::vector<float> accel_z_m_per_s2;
  std::vector<float> accel_motor_z_m_per_s2;
  std::uint64_t lost_samples{};  // missing among them, of each, since the recording started
};

/// The measuring side of a bench.
class Sampler {
 public:
  Sampler() = default;
  Sampler(const Sampler&) = delete;
  Sampler& operator=(const Sampler&) = delete;
  virtual ~Sampler() = default;

  /// The newest value of every slow channel. Never waits.
  virtual Readings Read() noexcept = 0;

  /// Starts keeping raw vibration at this rate, from now on, until stopped.
  virtual void StartVibration(double sample_rate_hz) = 0;
  virtual void StopVibration() = 0;
  /// Appends what came in since the last call. Called between control periods, so it may allocate.
  virtual void DrainVibration(VibrationBlock& block) = 0;

  /// A fault has just stopped the bench: raw samples around this moment are worth keeping. Not for the cycle.
  virtual void MarkTrip() {}

  /// Asks for the shunt resistor of the torque transducer to be connected, or taken off; the reading tells
  /// when it is. Never waits. Nothing happens on a bench without one.
  virtual void ConnectShunt(bool) noexcept {}
};

}  // namespace strainwave::bench
