// SPDX-License-Identifier: Apache-2.0
#include "bench/machines/field/field_sampler.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "analysis/units.h"

namespace strainwave::bench {
namespace {

constexpr const char* kNames[] = {"input_angle",  "output_angle",     "input_speed",         "output_torque",
                                  "motor_torque", "gear_temperature", "ambient_temperature", "vibration_rms"};

// Those without which nothing may turn; the oldest of them is the age of the readings.
constexpr Channel kGuards[] = {Channel::kInputAngle, Channel::kOutputAngle, Channel::kInputSpeed,
                               Channel::kOutputTorque};

constexpr std::size_t At(Channel channel) { return static_cast<std::size_t>(channel); }

}  // namespace

FieldSampler::FieldSampler(FieldChannels channels, const BenchClock& clock)
    : channels_(std::move(channels)), clock_(clock) {
  for (const Channel needed : {Channel::kInputAngle, Channel::kOutputAngle, Channel::kInputSpeed,
                               Channel::kOutputTorque, Channel::kGearTemperature}) {
    if (!channels_.channels[At(needed)]) {
      throw std::invalid_argument(
          fmt::format("channel {} comes from nowhere (must have a source)", kNames[At(needed)]));
    }
  }
}

Readings FieldSampler::Read() noexcept {
  Readings readings;
  readings.time = clock_.Now();
  std::array<double, 8> values{};
  std::array<std::chrono::nanoseconds, 8> times{};
  times.fill(readings.time);  // of a channel without a source
  for (std::size_t i = 0; i < channels_.channels.size(); ++i) {
    if (!channels_.channels[i]) continue;
    const ChannelValue value = channels_.channels[i]();
    values[i] = value.value;
    times[i] = value.sampled.count() != 0 ? value.sampled : value.time;
    if (!value.good) readings.bad_channels |= 1U << i;
    if (std::ranges::find(kGuards, static_cast<Channel>(i)) != std::end(kGuards)) {
      readings.time = std::min(readings.time, value.time);
    }
  }
  readings.input_angle_time = times[At(Channel::kInputAngle)];
  readings.output_angle_time = times[At(Channel::kOutputAngle)];
  readings.input_speed_time = times[At(Channel::kInputSpeed)];
  readings.torque_time = times[At(Channel::kOutputTorque)];
  readings.motor_torque_time = times[At(Channel::kMotorTorque)];
  readings.input_angle_rad = values[At(Channel::kInputAngle)];
  readings.input_speed_rad_per_s = values[At(Channel::kInputSpeed)];
  readings.output_angle_rad = values[At(Channel::kOutputAngle)];
  readings.output_torque_Nm = values[At(Channel::kOutputTorque)];
  readings.motor_torque_Nm = values[At(Channel::kMotorTorque)];
  readings.gear_temperature_degC = values[At(Channel::kGearTemperature)];
  readings.ambient_temperature_degC = values[At(Channel::kAmbientTemperature)];
  readings.vibration_rms_m_per_s2 = values[At(Channel::kVibrationRms)];
  readings.quick_stop_pressed = channels_.quick_stop_pressed && channels_.quick_stop_pressed();
  return readings;
}

void FieldSampler::StartVibration(double sample_rate_hz) {
  if (channels_.vibration == nullptr) return;
  std::vector<std::size_t> wanted;
  for (const auto& channel : channels_.accelerometers) {
    if (channel) wanted.push_back(*channel);
  }
  channels_.vibration->StartCapture(wanted, sample_rate_hz);
}

void FieldSampler::StopVibration() {
  if (channels_.vibration != nullptr) channels_.vibration->StopCapture();
}

void FieldSampler::DrainVibration(VibrationBlock& block) {
  if (channels_.vibration == nullptr) return;
  std::vector<float>* const all[] = {&block.accel_x_m_per_s2, &block.accel_y_m_per_s2,
                                     &block.accel_z_m_per_s2, &block.accel_motor_z_m_per_s2};
  std::array<std::vector<float>*, 4> wanted{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (channels_.accelerometers[i]) wanted[count++] = all[i];
  }
  channels_.vibration->Drain(std::span(wanted.data(), count));
  block.lost_samples = channels_.vibration->lost_in_capture();
}

double SiFactor(std::string_view channel_name) {
  constexpr std::pair<std::string_view, double> kUnits[] = {{"_deg", RadFromDeg(1.0)},
                                                            {"_arcmin", RadFromArcmin(1.0)},
                                                            {"_rad", 1.0},
                                                            {"_rpm", RadPerSFromRpm(1.0)},
                                                            {"_rad_per_s", 1.0},
                                                            {"_Nm", 1.0},
                                                            {"_degC", 1.0},
                                                            {"_m_per_s2", 1.0}};
  for (const auto& [ending, factor] : kUnits) {
    if (channel_name.ends_with(ending)) return factor;
  }
  throw std::invalid_argument(fmt::format(
      "channel '{}' does not end in its unit (must in _deg, _arcmin, _rad, _rpm, _rad_per_s, _Nm, "
      "_degC or _m_per_s2)",
      channel_name));
}

}  // namespace strainwave::bench
