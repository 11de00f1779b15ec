// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/field/field_machine.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "analysis/units.h"
#include "bench/campaign/campaign_error.h"
#include "bench/configuration/read_bench_file.h"
#include "bench/configuration/read_drive_profile.h"
#include "bench/configuration/read_register_map.h"
#include "bench/controller/realtime.h"
#include "bench/devices/can/socket_can_bus.h"
#include "bench/devices/modbus/modbus_address.h"
#include "bench/devices/plant_model_of.h"
#include "bench/devices/tcp_address.h"
#include "daq/acquisition/sources/iio_source.h"
#include "daq/acquisition/sources/tcp_stream_source.h"

namespace strainwave::bench {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Kind = DeviceDescription::Kind;

namespace {

constexpr std::string_view kInProcess = "in_process";
constexpr seconds kCommissioning{20};
constexpr milliseconds kBootUp{50};
// A channel of a stream that is older is not a value any more.
constexpr milliseconds kStale{100};

}  // namespace

FieldMachine::FieldMachine(const BenchDescription& bench, double ratio, const AskOperator& ask)
    : bench_(bench), ask_(ask) {
  if (bench_.devices.empty()) {
    throw CampaignError(
        ExitCode::kWrongInput,
        fmt::format("{}: error: the bench has no devices (expected devices, channels and a drive for "
                    "each servo, or simulated: true)",
                    bench_.file_name));
  }
  try {
    OpenBuses();
    StartDeviceSide(ratio);
    OpenDrives();
    OpenModbus();
    OpenSources();
    sampler_ = std::make_unique<FieldSampler>(Channels(), clock_);
  } catch (const std::system_error& error) {
    throw CampaignError(ExitCode::kMachineFailed,
                        fmt::format("{}: error: {}", bench_.file_name, error.what()));
  } catch (const std::invalid_argument& error) {
    throw CampaignError(ExitCode::kWrongInput, fmt::format("{}: error: {}", bench_.file_name, error.what()));
  } catch (const schedules::FileError& error) {
    throw CampaignError(ExitCode::kWrongInput, error.what());
  }
}

FieldMachine::~FieldMachine() {
  // The drives come to rest while everything that they need is still there.
  modbus_servos_.clear();
  for (auto& [name, bus] : buses_) bus.thread.reset();
  sampler_.reset();
  sources_.clear();
  modbus_.clear();
  ending_ = true;
  if (device_side_thread_.joinable()) device_side_thread_.join();
}

BenchDevices FieldMachine::Devices() { return {*driving_, *load_, *sampler_, clock_}; }

const DeviceDescription& FieldMachine::Named(const std::string& name) const {
  const auto found = std::ranges::find(bench_.devices, name, &DeviceDescription::name);
  if (found == bench_.devices.end()) throw std::invalid_argument(fmt::format("there is no device {}", name));
  return *found;
}

std::string FieldMachine::AddressOf(const DeviceDescription& device) const {
  const std::string played = device_side_ ? device_side_->AddressOf(device.name) : "";
  return played.empty() ? device.address : played;
}

void FieldMachine::OpenBuses() {
  for (const DeviceDescription& device : bench_.devices) {
    if (device.kind != Kind::kCanopen) continue;
    OneBus& bus = buses_[device.name];
    if (device.address == kInProcess) {
      bus.in_process =
          std::make_unique<InProcessCanBus>(InProcessCanSettings{.ends = 3, .transmit_frames = 64});
      bus.bus = &bus.in_process->end(0);
    } else {
      SocketCanSettings settings;
      settings.interface = device.address;
      settings.clock_zero = -clock_.FromKernel({});
      bus.own = std::make_unique<SocketCanBus>(settings);
      bus.bus = bus.own.get();
    }
  }
}

void FieldMachine::StartDeviceSide(double ratio) {
  DeviceSideBuses ends;
  for (auto& [name, bus] : buses_) {
    if (bus.in_process) ends[name] = {&bus.in_process->end(1), &bus.in_process->end(2)};
  }
  if (ends.empty()) return;
  device_side_ = std::make_unique<DeviceSide>(bench_, PlantModelOf(bench_, ratio), ends);
  device_side_thread_ = std::thread([this] { RunDeviceSide(); });
}

void FieldMachine::RunDeviceSide() {
  (void)BecomeRealtime(RealtimeRank::kDeviceSide);
  MonotonicClock pace;
  auto next = pace.Now();
  while (!ending_) {
    const auto now = clock_.Now();
    for (auto& [name, bus] : buses_) {
      if (bus.in_process) bus.in_process->Exchange(now);
    }
    device_side_->Step(now);
    for (auto& [name, bus] : buses_) {
      if (bus.in_process) bus.in_process->Exchange(clock_.Now());
    }
    next += DeviceSide::kStep;
    pace.SleepUntil(next);
    next = std::max(next, pace.Now() - DeviceSide::kStep);
  }
}

ServoDrive& FieldMachine::OpenDrive(const ServoDescription& servo, const std::string& name) {
  const DeviceDescription& device = Named(servo.drive.device);
  const double reducer = name == "load servo" ? bench_.load_reducer_ratio : 1.0;
  if (device.kind == Kind::kModbus) {
    const ModbusProfile profile = ReadModbusProfile(device.file);
    if (!profile.servo) {
      throw std::invalid_argument(
          fmt::format("{} describes no servo drive (must, as the {} is one)", device.file.string(), name));
    }
    ModbusSettings settings;
    settings.port = ParseModbusAddress(AddressOf(device));
    settings.unit = device.unit;
    modbus_servos_.push_back(
        std::make_unique<ModbusServoDrive>(settings, profile.map, *profile.servo, clock_));
    return *modbus_servos_.back();
  }
  OneBus& bus = buses_.at(device.name);
  CanopenServoSettings settings;
  settings.name = name;
  settings.profile = AtAxis(ReadDriveProfile(servo.drive.profile), reducer, 1);
  settings.node_id = static_cast<std::uint8_t>(servo.drive.node);
  bus.drives.push_back(std::move(settings));
  return *load_;  // known when the bus is served
}

void FieldMachine::OpenDrives() {
  const auto on_can = [&](const ServoDescription& servo) {
    return Named(servo.drive.device).kind == Kind::kCanopen;
  };
  for (const auto& [servo, name, place] : {std::tuple(&bench_.driving_servo, "driving servo", &driving_),
                                           std::tuple(&bench_.load_servo, "load servo", &load_)}) {
    const ServoDescription& description = *servo;
    if (!on_can(description)) {
      *place = &OpenDrive(description, name);
    } else {
      OpenDrive(description, name);
    }
  }
  std::string troubles;
  for (auto& [name, bus] : buses_) {
    if (bus.drives.empty()) continue;
    std::vector<std::string> names;
    for (const CanopenServoSettings& drive : bus.drives) names.push_back(drive.name);
    bus.served = std::make_unique<DriveBus>(*bus.bus, clock_, std::move(bus.drives));
    bus.thread = std::make_unique<DriveBusThread>(*bus.served, clock_);
    for (std::size_t i = 0; i < names.size(); ++i) {
      (names[i] == "driving servo" ? driving_ : load_) = &bus.served->servo(i);
    }
    // Drives that have just been switched on say so, and then have lost what was set up before.
    std::this_thread::sleep_for(kBootUp);
    std::string first = bus.thread->Commission(kCommissioning);
    if (!first.empty()) first = bus.thread->Commission(kCommissioning);
    troubles += first;
  }
  if (!troubles.empty()) {
    throw CampaignError(ExitCode::kMachineFailed,
                        fmt::format("{}: error: the drives cannot be used\n{}", bench_.file_name, troubles));
  }
}

void FieldMachine::OpenModbus() {
  for (const DeviceDescription& device : bench_.devices) {
    const bool has_channels = std::ranges::any_of(
        bench_.channels, [&](const ChannelLink& link) { return link.device == device.name; });
    if (device.kind != Kind::kModbus || !has_channels) continue;
    ModbusSettings settings;
    settings.port = ParseModbusAddress(AddressOf(device));
    settings.unit = device.unit;
    modbus_[device.name] =
        std::make_unique<ModbusClient>(settings, ReadModbusProfile(device.file).map, clock_);
  }
}

void FieldMachine::OpenSources() {
  std::uint32_t number = 0;
  for (const DeviceDescription& device : bench_.devices) {
    if (device.kind == Kind::kStream) {
      const TcpAddress at = ParseTcpAddress(AddressOf(device));
      daq::acquisition::TcpStreamSettings settings;
      settings.host = at.host;
      settings.port = static_cast<std::uint16_t>(at.port);
      settings.source = ++number;
      sources_[device.name] = std::make_unique<SourceReader>(
          std::make_unique<daq::acquisition::TcpStreamSource>(settings), clock_);
    }
  }
}

std::function<ChannelValue()> FieldMachine::ChannelFrom(const ChannelLink& link) {
  const double to_si = SiFactor(link.source);
  if (const auto found = sources_.find(link.device); found != sources_.end()) {
    const SourceReader* const reader = found->second.get();
    const auto channel = reader->Find(link.source);
    if (!channel) {
      throw std::invalid_argument(
          fmt::format("line {}: device {} has no channel {} (must be one that it sends)", link.line,
                      link.device, link.source));
    }
    return [this, reader, at = *channel, to_si] {
      const SourceSnapshot snapshot = reader->Newest();
      const bool fresh = snapshot.time.count() != 0 && clock_.Now() - snapshot.time < kStale;
      return ChannelValue{snapshot.values[at] * to_si, snapshot.time,
                          fresh && (snapshot.bad_channels >> at & 1U) == 0};
    };
  }
  const auto found = modbus_.find(link.device);
  if (found == modbus_.end()) {
    throw std::invalid_argument(fmt::format(
        "line {}: device {} has no channels here (must be a stream or on Modbus)", link.line, link.device));
  }
  const ModbusClient* const client = found->second.get();
  const std::string name = link.source.substr(0, link.source.rfind('_'));
  const auto index = protocols::modbus::Find(client->map(), link.source);
  const auto bare = index ? index : protocols::modbus::Find(client->map(), name);
  if (!bare) {
    throw std::invalid_argument(fmt::format("line {}: device {} has no register {} (must be one of its map)",
                                            link.line, link.device, link.source));
  }
  // The map has made SI of it already.
  return [client, at = *bare] { return client->Value(at); };
}

FieldChannels FieldMachine::Channels() {
  FieldChannels channels;
  constexpr std::pair<std::string_view, Channel> kSlow[] = {
      {"input_angle", Channel::kInputAngle},
      {"output_angle", Channel::kOutputAngle},
      {"input_speed", Channel::kInputSpeed},
      {"output_torque", Channel::kOutputTorque},
      {"motor_torque", Channel::kMotorTorque},
      {"gear_temperature", Channel::kGearTemperature},
      {"ambient_temperature", Channel::kAmbientTemperature}};
  constexpr std::string_view kAccelerometers[] = {"accel_x", "accel_y", "accel_z", "accel_motor_z"};
  for (const ChannelLink& link : bench_.channels) {
    const auto* const slow =
        std::ranges::find_if(kSlow, [&](const auto& known) { return known.first == link.channel; });
    if (slow != std::end(kSlow)) {
      channels.channels[static_cast<std::size_t>(slow->second)] = ChannelFrom(link);
      continue;
    }
    const auto* const axis = std::ranges::find(kAccelerometers, link.channel);
    const auto source = sources_.find(link.device);
    if (axis == std::end(kAccelerometers) || source == sources_.end()) continue;
    const auto channel = source->second->Find(link.source);
    if (!channel || (channels.vibration != nullptr && channels.vibration != source->second.get())) {
      throw std::invalid_argument(
          fmt::format("line {}: {} is not a channel of {} (must be, and all accelerometers of one device)",
                      link.line, link.source, link.device));
    }
    channels.vibration = source->second.get();
    channels.accelerometers[static_cast<std::size_t>(axis - std::begin(kAccelerometers))] = *channel;
  }
  const auto from_drive = [this](double DriveActual::*value) {
    return [this, value] {
      const DriveActual actual = driving_->Actual();
      return ChannelValue{actual.*value, actual.time, clock_.Now() - actual.time < kStale};
    };
  };
  auto& speed = channels.channels[static_cast<std::size_t>(Channel::kInputSpeed)];
  if (!speed) speed = from_drive(&DriveActual::speed_rad_per_s);
  auto& torque = channels.channels[static_cast<std::size_t>(Channel::kMotorTorque)];
  if (!torque) torque = from_drive(&DriveActual::torque_Nm);
  if (channels.vibration != nullptr) {
    channels.channels[static_cast<std::size_t>(Channel::kVibrationRms)] = [this,
                                                                           reader = channels.vibration] {
      const SourceSnapshot snapshot = reader->Newest();
      const bool fresh = snapshot.time.count() != 0 && clock_.Now() - snapshot.time < kStale;
      return ChannelValue{snapshot.vibration_rms_m_per_s2, snapshot.time,
                          fresh && snapshot.bad_channels == 0};
    };
  }
  return channels;
}

void FieldMachine::MountBlank(bool mounted) {
  if (device_side_) {
    device_side_->Do(mounted ? "blank on" : "blank off");
    return;
  }
  const std::string what =
      mounted ? "mount the rigid blank in the gear's place" : "put the gear back in its place";
  if (ask_ && ask_(what)) return;
  throw CampaignError(
      ExitCode::kInterrupted,
      fmt::format("nobody has confirmed: {} (expected a person at the terminal; go on with --resume)", what));
}

std::vector<FieldMachine::DeviceState> FieldMachine::States() const {
  std::vector<DeviceState> states;
  for (const auto& [name, bus] : buses_) {
    if (!bus.served) continue;
    const DriveBusCounts counts = bus.served->counts();
    states.push_back(
        {name, fmt::format("{} frames sent, {} received, {} lost", counts.sent, counts.received, counts.lost),
         counts.lost == 0 && counts.state == CanState::kErrorActive});
    for (std::size_t i = 0; i < bus.served->size(); ++i) {
      CanopenServo& servo = bus.served->servo(i);
      const ServoReport report = servo.report();
      const std::string words = report.words.data();
      const bool good = report.stage == protocols::canopen::DriveStage::kDisabled && words.empty();
      states.push_back({fmt::format("{}, node {}", servo.name(), servo.settings().node_id),
                        words.empty() ? std::string(Name(report.stage)) : words, good});
    }
  }
  for (const auto& [name, client] : modbus_) {
    const std::string trouble = client->trouble();
    states.push_back({name,
                      trouble.empty() ? (client->connected() ? "connected" : "not yet connected") : trouble,
                      trouble.empty() && client->connected()});
  }
  for (const auto& [name, reader] : sources_) {
    const std::string trouble = reader->Trouble();
    const daq::acquisition::GapTotals totals = reader->totals();
    states.push_back(
        {name, trouble.empty() ? fmt::format("{} samples, {} lost", totals.received, totals.lost) : trouble,
         trouble.empty() && totals.received > 0});
  }
  return states;
}

std::string FieldMachine::Troubles() const {
  std::string all;
  for (const DeviceState& state : States()) {
    if (state.good || state.state == Name(protocols::canopen::DriveStage::kStopped)) continue;
    all += fmt::format("{}{}: {}", all.empty() ? "" : "\n", state.device, state.state);
  }
  return all;
}

}  // namespace strainwave::bench
