// SPDX-License-Identifier: Apache-2.0
#include "bench/machines/device_side/device_side.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "analysis/units.h"
#include "bench/configuration/read_drive_profile.h"
#include "bench/configuration/read_register_map.h"
#include "bench/devices/monotonic_clock.h"
#include "bench/devices/tcp_address.h"
#include "bench/machines/device_side/device_side_parts.h"
#include "bench/machines/device_side/own_drive.h"

namespace strainwave::bench {

using daq::acquisition::ChannelDescription;
using daq::acquisition::SampleBlock;
using daq::acquisition::SampleType;
using daq::acquisition::SourceDescription;
using std::chrono::nanoseconds;
using Kind = DeviceDescription::Kind;

namespace {

// A converter of 24 bits whose range is a quarter wider than the sensor's.
constexpr double kConverterEnd = 8388607.0;
constexpr double kReserve = 1.25;
// Counts of a turn as a stream sends them: 32 bits then go over after 128 turns either way.
constexpr double kMostCountsPerTurn = 16777216.0;
constexpr std::uint32_t kVibrationBlocksPerSecond = 200;

SimulatedBenchSettings SettingsOf(const SimulationDescription& simulation) {
  SimulatedBenchSettings settings;
  settings.seed = simulation.seed;
  settings.time_skew_s = simulation.time_skew_s;
  return settings;
}

// How a channel of the bench is sent: counts, what makes degrees, Nm or m/s² of them, and how much noise it
// has by its data sheet, without which nobody can tell a quiet sensor from one that is stuck.
ChannelDescription Sent(const BenchDescription& bench, const analysis::model::PlantParameters& plant,
                        const ChannelLink& link) {
  ChannelDescription channel;
  channel.name = link.source;
  auto& calibration = channel.calibration;
  double noise = 0.0;
  const auto converter = [&](double range) {
    calibration.sensitivity = kConverterEnd / (kReserve * range);
    channel.limits.saturation_low = -kConverterEnd - 1.0;
    channel.limits.saturation_high = kConverterEnd;
  };
  const auto holds_until = [&](const std::string& due) {
    if (!due.empty()) calibration.due = daq::acquisition::DateFrom(due);
  };
  const auto encoder = [&](const EncoderDescription& description, const analysis::model::Encoder& simulated) {
    channel.unit = "deg";
    channel.sensor_serial = description.serial;
    calibration.id = description.calibration;
    holds_until(description.calibration_due);
    calibration.sensitivity =
        std::min(static_cast<double>(description.counts_per_rev), kMostCountsPerTurn) / 360.0;
    noise = DegFromRad(simulated.noise_rad);
  };
  if (link.channel == "input_angle") {
    encoder(bench.input_encoder, plant.input_encoder);
  } else if (link.channel == "output_angle") {
    encoder(bench.output_encoder, plant.output_encoder);
  } else if (link.channel == "output_torque") {
    channel.unit = "Nm";
    channel.sensor_serial = bench.transducer.serial;
    calibration.id = bench.transducer.calibration;
    holds_until(bench.transducer.calibration_due);
    converter(bench.transducer.range_Nm);
    noise = plant.transducer.noise_Nm;
  } else {
    const auto found = std::ranges::find(bench.accelerometers, link.channel, &AccelerometerDescription::name);
    if (found == bench.accelerometers.end()) {
      throw std::invalid_argument(
          fmt::format("channel {} of device {} is none that a stream has here (must be an "
                      "angle, the torque or an accelerometer)",
                      link.channel, link.device));
    }
    channel.unit = "m/s^2";
    channel.sensor_serial = found->serial;
    calibration.id = found->calibration;
    holds_until(found->calibration_due);
    converter(found->range_m_per_s2);
    noise = plant.vibration.sensor_noise_m_per_s2;
  }
  channel.limits.noise = noise * calibration.sensitivity;
  if (calibration.id.empty()) calibration.id = "none";  // so that the sensitivity is sent
  return channel;
}

// A converter stands at its ends; an encoder has none, and goes over at 32 bits.
std::uint32_t Word(double value, const ChannelDescription& channel) {
  const double counts = std::round(value * channel.calibration.sensitivity);
  const std::optional<double>& low = channel.limits.saturation_low;
  const std::optional<double>& high = channel.limits.saturation_high;
  return static_cast<std::uint32_t>(
      static_cast<std::int64_t>(low && high ? std::clamp(counts, *low, *high) : counts));
}

}  // namespace

DeviceSide::DeviceSide(const BenchDescription& bench, const analysis::model::PlantModel& model,
                       DeviceSideBuses buses)
    : step_(static_cast<std::int64_t>(1e9 * bench.fast_control_period_s + 0.5)),
      bench_(model, SettingsOf(bench.simulation)),
      input_counts_(bench.input_encoder.sign),
      output_counts_(bench.output_encoder.sign) {
  AddDrive(bench, bench.driving_servo, bench_.driving_servo(), 1.0, buses);
  AddDrive(bench, bench.load_servo, bench_.load_servo(), bench.load_reducer_ratio, buses);
  const analysis::model::PlantParameters plant = CompilePlantModel(model);
  for (const DeviceDescription& device : bench.devices) {
    switch (device.kind) {
      case Kind::kModbus:
        // A drive is there already.
        if (!modbus_.contains(device.name)) AddModbus(device);
        break;
      case Kind::kTorqueAmplifier:
      case Kind::kTemperatureController:
        AddModbus(device);
        break;
      case Kind::kStream:
        AddStream(bench, plant, device);
        break;
      case Kind::kCanopen:
      case Kind::kIio:
      case Kind::kPendant:
      case Kind::kStoContact:
      case Kind::kHid:
      case Kind::kCamera:
        break;
    }
  }
  if (vibrates_) bench_.sampler().StartVibration(bench.vibration_rate_hz);
  if (IsSafe()) safe_since_ = bench_now_;
}

DeviceSide::~DeviceSide() = default;

bool IsInProcess(const DeviceDescription& device) {
  std::string_view address = device.address;
  if (address.starts_with("tcp:") || address.starts_with("rtu:")) address.remove_prefix(4);
  return address == kInProcess;
}

void DeviceSide::AddDrive(const BenchDescription& bench, const ServoDescription& servo, ServoDrive& simulated,
                          double reducer_ratio, DeviceSideBuses& buses) {
  const DeviceDescription* const device = FindDevice(bench.devices, servo.drive.device);
  if (device == nullptr || (device->kind != Kind::kCanopen && device->kind != Kind::kModbus)) {
    throw std::invalid_argument(
        fmt::format("device {} drives a servo (must be of kind canopen or modbus here)", servo.drive.device));
  }
  const bool is_modbus = device->kind == Kind::kModbus;
  drives_.push_back(std::make_unique<Drive>(is_modbus ? device->name : std::to_string(servo.drive.node),
                                            simulated, reducer_ratio));
  Drive& drive = *drives_.back();
  if (is_modbus) return AddModbusDrive(*device, drive);
  std::vector<CanBus*>& ends = buses.at(device->name);
  if (ends.empty()) throw std::invalid_argument(fmt::format("bus {} has too few ends", device->name));
  const protocols::canopen::EdsFile& eds = OwnDriveEds();
  ServoUnits units = UnitsOf(eds, 1);
  // The simulated servo speaks of the shaft behind its reducer.
  units.increments_per_turn *= reducer_ratio;
  units.rated_torque_Nm *= reducer_ratio;
  drive.canopen =
      std::make_unique<PlayedCanopenDrive>(eds, servo.drive.node, drive.servo, units, *ends.front());
  ends.erase(ends.begin());
}

void DeviceSide::AddStream(const BenchDescription& bench, const analysis::model::PlantParameters& plant,
                           const DeviceDescription& device) {
  SourceDescription source;
  source.name = device.name;
  source.type = SampleType::kInt32;
  std::vector<std::string> channels;
  bool vibration = false;
  for (const ChannelLink& link : bench.channels) {
    if (link.device != device.name) continue;
    source.channels.push_back(Sent(bench, plant, link));
    vibration = vibration || source.channels.back().unit == "m/s^2";
    channels.push_back(link.channel);
  }
  if (channels.empty()) {
    throw std::invalid_argument(fmt::format("device {} has no channels (must have one)", device.name));
  }
  source.rate_hz = vibration ? bench.vibration_rate_hz : 1.0 / bench.fast_control_period_s;
  source.most_samples_a_block =
      vibration ? static_cast<std::uint32_t>(source.rate_hz / kVibrationBlocksPerSecond) + 1 : 1;
  const TcpAddress at = ParseTcpAddress(device.address);
  auto server = std::make_unique<StreamServer>(source, at.host, at.port);
  SampleBlock block(channels.size() * source.most_samples_a_block);
  block.header.channels = static_cast<std::uint32_t>(channels.size());
  block.header.type = source.type;
  block.header.rate_hz = source.rate_hz;
  vibrates_ = vibrates_ || vibration;
  streams_.push_back(std::make_unique<Stream>(
      Stream{device.name, std::move(channels), vibration, std::move(server), std::move(block), 0}));
}

void RunInRealTime(DeviceSide& devices, const BenchClock& clock, const std::atomic<bool>& ending,
                   const std::function<void()>& exchange, nanoseconds period) {
  period = std::max(period, devices.step());
  MonotonicClock pace;
  nanoseconds next = pace.Now();
  while (!ending) {
    if (exchange) exchange();
    devices.Step(clock.Now());
    if (exchange) exchange();
    next += period;
    pace.SleepUntil(next);
    next = std::max(next, pace.Now() - period);
  }
}

void DeviceSide::Step(nanoseconds now) {
  const std::lock_guard lock(mutex_);
  for (const auto& drive : drives_) {
    if (drive->canopen) drive->canopen->on_bus.TakeFrames(now);
  }
  // A hold-up is caught up with, but not one of seconds: the shafts have stood meanwhile.
  constexpr nanoseconds kMostBehind = std::chrono::milliseconds(500);
  bench_now_ = std::max(bench_now_, now - kMostBehind);
  while (bench_now_ + step_ <= now) {
    bench_now_ += step_;
    // The drives' own ramps go with the shafts, step by step.
    for (const auto& drive : drives_) {
      if (drive->canopen) drive->canopen->node.Poll(bench_now_);
      if (drive->modbus) drive->modbus->Turn(drive->servo, drive->reducer_ratio, clock_.Now());
    }
    bench_.sampler().ConnectShunt(shunted_);
    bench_.clock().SleepUntil(bench_.clock().Now() + step_);
    served_.Step(drives_[0]->servo, drives_[1]->servo, std::chrono::duration<double>(step_).count());
    const Readings readings = bench_.sampler().Read();
    gear_temperature_degC_ = readings.gear_temperature_degC;
    ambient_temperature_degC_ = readings.ambient_temperature_degC;
    output_torque_Nm_ = readings.output_torque_Nm;
    if (vibrates_) bench_.sampler().DrainVibration(vibration_);
    for (const auto& stream : streams_) FillStream(*stream, readings);
    safe_since_ = IsSafe() ? safe_since_.value_or(bench_now_) : std::optional<nanoseconds>();
  }
  for (const auto& drive : drives_) {
    if (drive->canopen) drive->canopen->on_bus.GiveFrames();
  }
}

void DeviceSide::FillStream(Stream& stream, const Readings& readings) {
  SampleBlock& block = stream.block;
  const auto& channels = stream.server->description().channels;
  const auto send = [&](std::uint32_t samples) {
    block.header.samples = samples;
    block.header.device_counter = stream.counter;
    // By the device's own clock, which its samples are taken on.
    block.header.device_time =
        nanoseconds(std::llround(1e9 * static_cast<double>(stream.counter) / block.header.rate_hz));
    stream.server->Push(block);
    stream.counter += samples;
  };
  // An input with nothing on it runs to an end of its converter; an encoder has none.
  constexpr double kAtItsEnd = std::numeric_limits<double>::infinity();
  const auto is_in = [](unsigned set, Channel channel) {
    return (set >> static_cast<unsigned>(channel) & 1U) != 0;
  };
  const auto dead = [&](Channel channel) { return is_in(injected_.dead_channels, channel); };
  if (!stream.is_vibration) {
    block.header.samples = 1;
    const std::span<std::uint32_t> words = block.words();
    for (std::size_t i = 0; i < channels.size(); ++i) {
      const std::string& name = stream.channels[i];
      const double value = name == "input_angle"    ? input_counts_ * DegFromRad(readings.input_angle_rad)
                           : name == "output_angle" ? output_counts_ * DegFromRad(readings.output_angle_rad)
                           : dead(Channel::kOutputTorque) ? kAtItsEnd
                                                          : readings.output_torque_Nm;
      words[i] = Word(value, channels[i]);
    }
    return send(1);
  }
  const std::pair<const char*, const std::vector<float>*> all[] = {
      {"accel_x", &vibration_.accel_x_m_per_s2},
      {"accel_y", &vibration_.accel_y_m_per_s2},
      {"accel_z", &vibration_.accel_z_m_per_s2},
      {"accel_motor_z", &vibration_.accel_motor_z_m_per_s2}};
  const std::size_t count = vibration_.accel_x_m_per_s2.size();
  const std::uint32_t most = stream.server->description().most_samples_a_block;
  // Whole blocks alone: what is left waits for the next step.
  std::size_t from = 0;
  for (; from + most <= count; from += most) {
    block.header.samples = most;
    const std::span<std::uint32_t> words = block.words();
    for (std::size_t i = 0; i < channels.size(); ++i) {
      const auto* const found =
          std::ranges::find_if(all, [&](const auto& named) { return stream.channels[i] == named.first; });
      const std::uint32_t last = words[(most - 1) * channels.size() + i];  // of the block before
      for (std::uint32_t sample = 0; sample < most; ++sample) {
        std::uint32_t& word = words[sample * channels.size() + i];
        if (is_in(injected_.frozen_channels, Channel::kVibrationRms)) {
          word = last;
        } else if (dead(Channel::kVibrationRms)) {
          word = Word(kAtItsEnd, channels[i]);
        } else {
          word = found == std::end(all) ? 0U : Word((*found->second)[from + sample], channels[i]);
        }
      }
    }
    send(most);
  }
  if (from == 0) return;
  for (auto* samples : {&vibration_.accel_x_m_per_s2, &vibration_.accel_y_m_per_s2,
                        &vibration_.accel_z_m_per_s2, &vibration_.accel_motor_z_m_per_s2}) {
    samples->erase(samples->begin(), samples->begin() + static_cast<std::ptrdiff_t>(from));
  }
}

bool DeviceSide::StandsSafe() { return SafeSince().has_value(); }

std::optional<nanoseconds> DeviceSide::SafeSince() {
  const std::lock_guard lock(mutex_);
  // A command may have changed it since the last step.
  return IsSafe() ? safe_since_ : std::nullopt;
}

bool DeviceSide::IsSafe() {
  const auto off = [](const DriveActual& drive) {
    return drive.brake_engaged && drive.power != protocols::PowerState::kOperationEnabled;
  };
  return off(bench_.driving_servo().Actual()) && off(bench_.load_servo().Actual());
}

std::string DeviceSide::AddressOf(const std::string& device) const {
  for (const auto& stream : streams_) {
    if (stream->device == device) return fmt::format("tcp:127.0.0.1:{}", stream->server->port());
  }
  const auto found = modbus_.find(device);
  if (found == modbus_.end()) return {};
  return found->second->path().empty() ? fmt::format("tcp:127.0.0.1:{}", found->second->port())
                                       : fmt::format("rtu:{}:19200:8E1", found->second->path());
}

}  // namespace strainwave::bench
