// SPDX-License-Identifier: Apache-2.0
#include "bench/safety/interlocks.h"

#include <algorithm>
#include <cmath>

namespace strainwave::bench {
namespace {

bool DriveFaulted(const DriveActual& drive) noexcept {
  return drive.power == protocols::PowerState::kFault ||
         drive.power == protocols::PowerState::kFaultReactionActive;
}

// A not-a-number compares false with every limit, so it is asked for by its own name.
bool Beyond(double magnitude, double limit) noexcept { return !(std::abs(magnitude) <= limit); }

}  // namespace

std::vector<InterlockRow> Interlocks::Table(const BenchSensors& sensors) {
  constexpr std::string_view kStop = "torque off, brakes on";
  constexpr std::string_view kSuspend = "suspend, resume by itself";
  return {
      {"output torque", "limits.output_torque", kStop, {StopCause::kOutputTorqueLimit}},
      {"input speed", "limits.input_speed", kStop, {StopCause::kInputSpeedLimit}},
      {"gear temperature", "limits.gear_temperature", kStop, {StopCause::kGearTemperatureLimit}},
      {"vibration RMS",
       "limits.vibration_rms",
       kStop,
       {StopCause::kVibrationLimit},
       sensors.vibration ? "" : "the bench has no accelerometers"},
      {"twist, input locked", "limits.twist", kStop, {StopCause::kTwistLimit}},
      {"age of the readings", "stale_after, else three control periods", kStop, {StopCause::kStaleReadings}},
      {"torque, angles, input speed", "a plausible value", kStop, {StopCause::kImplausibleReading}},
      {"input angle", "the driving servo's own", kStop, {StopCause::kInputAngleApart}},
      {"drive fault", "power state fault", kStop, {StopCause::kDriveFault}},
      {"drive enabled",
       "in operation enabled, brake off",
       kStop,
       {StopCause::kDriveNotReady, StopCause::kDriveDroppedOut, StopCause::kBrakeEngaged}},
      {"age of a drive's state", "stale_after, else three control periods", kStop, {StopCause::kDriveSilent}},
      {"torque and speed asked for",
       "torque_tolerance, speed_tolerance",
       kStop,
       {StopCause::kTorqueAway, StopCause::kSpeedAway}},
      {"quick-stop key",
       "pressed, or its pendant gone",
       kStop,
       {StopCause::kQuickStopKey},
       sensors.quick_stop_key ? "" : "the bench has no pendant"},
      {"gear temperature", "suspend.trip_temperature", kSuspend, {StopCause::kTemperatureSuspend}},
      {"bad channel", "suspend.bad_sensor", kSuspend, {StopCause::kSensorSuspend}},
  };
}

void Interlocks::Lower(const schedules::Limits& limits) noexcept {
  const auto lower = [](double& limit, double to) { limit = std::min(limit, to); };
  lower(limits_.output_torque_Nm, limits.output_torque_Nm);
  lower(limits_.input_speed_rad_per_s, limits.input_speed_rad_per_s);
  lower(limits_.gear_temperature_degC, limits.gear_temperature_degC);
  lower(limits_.vibration_rms_m_per_s2, limits.vibration_rms_m_per_s2);
  lower(limits_.twist_rad, limits.twist_rad);
}

std::size_t Interlocks::CheckAll(const Readings& readings, const InterlockInputs& inputs,
                                 std::span<StopReason> causes) const noexcept {
  std::size_t count = 0;
  const auto add = [&](StopCause cause, double value, double limit, BenchServo servo = {}) {
    if (count < causes.size()) causes[count++] = {cause, value, limit, readings.time, servo};
  };
  const auto channel_good = [&](Channel channel) {
    return (readings.bad_channels & (1u << static_cast<unsigned>(channel))) == 0;
  };
  if (readings.quick_stop_pressed) add(StopCause::kQuickStopKey, 0.0, 0.0);
  const auto age = inputs.now - readings.time;
  if (age > longest_silence_) {
    add(StopCause::kStaleReadings, std::chrono::duration<double>(age).count(),
        std::chrono::duration<double>(longest_silence_).count());
  }
  if (channel_good(Channel::kOutputTorque) && Beyond(readings.output_torque_Nm, limits_.output_torque_Nm)) {
    add(StopCause::kOutputTorqueLimit, readings.output_torque_Nm, limits_.output_torque_Nm);
  }
  if (channel_good(Channel::kInputSpeed) &&
      Beyond(readings.input_speed_rad_per_s, limits_.input_speed_rad_per_s)) {
    add(StopCause::kInputSpeedLimit, readings.input_speed_rad_per_s, limits_.input_speed_rad_per_s);
  }
  if (channel_good(Channel::kGearTemperature) &&
      !(readings.gear_temperature_degC <= limits_.gear_temperature_degC)) {
    add(StopCause::kGearTemperatureLimit, readings.gear_temperature_degC, limits_.gear_temperature_degC);
  }
  if (channel_good(Channel::kVibrationRms) &&
      Beyond(readings.vibration_rms_m_per_s2, limits_.vibration_rms_m_per_s2)) {
    add(StopCause::kVibrationLimit, readings.vibration_rms_m_per_s2, limits_.vibration_rms_m_per_s2);
  }
  if (inputs.input_locked && Beyond(inputs.twist_rad, limits_.twist_rad)) {
    add(StopCause::kTwistLimit, inputs.twist_rad, limits_.twist_rad);
  }
  if (DriveFaulted(inputs.driving)) add(StopCause::kDriveFault, 0.0, 0.0, BenchServo::kDriving);
  if (DriveFaulted(inputs.load)) add(StopCause::kDriveFault, 0.0, 0.0, BenchServo::kLoad);
  // Torque and angle guard the specimen: without them nothing may turn, whatever the suspend rule says of
  // the slow channels.
  for (const Channel channel :
       {Channel::kOutputTorque, Channel::kInputAngle, Channel::kOutputAngle, Channel::kInputSpeed}) {
    if (!channel_good(channel)) add(StopCause::kImplausibleReading, static_cast<double>(channel), 0.0);
  }
  return count;
}

StopReason Interlocks::Check(const Readings& readings, const InterlockInputs& inputs) const noexcept {
  StopReason first;
  CheckAll(readings, inputs, {&first, 1});
  return first;
}

StopReason SuspendMonitor::Check(const Readings& readings, double period_s) noexcept {
  clear_for_s_ = 0.0;
  if (readings.gear_temperature_degC > rule_.trip_temperature_degC) {
    return {StopCause::kTemperatureSuspend, readings.gear_temperature_degC, rule_.trip_temperature_degC,
            readings.time};
  }
  bad_for_s_ = readings.bad_channels == 0 ? 0.0 : bad_for_s_ + period_s;
  if (bad_for_s_ > rule_.bad_sensor_s) {
    unsigned channel = 0;
    while ((readings.bad_channels & (1u << channel)) == 0) ++channel;
    return {StopCause::kSensorSuspend, static_cast<double>(channel), rule_.bad_sensor_s, readings.time};
  }
  return {};
}

void SuspendMonitor::LowerTrip(double trip_temperature_degC) noexcept {
  rule_.trip_temperature_degC = std::min(rule_.trip_temperature_degC, trip_temperature_degC);
}

bool SuspendMonitor::Recovered(const Readings& readings, double period_s) noexcept {
  const bool clear =
      readings.bad_channels == 0 && readings.gear_temperature_degC < rule_.resume_temperature_degC;
  clear_for_s_ = clear ? clear_for_s_ + period_s : 0.0;
  if (clear_for_s_ < rule_.dwell_s) return false;
  bad_for_s_ = 0.0;
  return true;
}

}  // namespace strainwave::bench
