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
#include "bench/configuration/read_hid_profile.h"
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

std::chrono::nanoseconds StaleAfter(const BenchDescription& bench) {
  const double age_s = bench.stale_after_s > 0.0 ? bench.stale_after_s : 3.0 * bench.control_period_s;
  return std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * age_s));
}

const protocols::HidField& FieldNamed(const HidProfile& profile, std::string_view name) {
  const auto found = std::ranges::find(profile.channels, name, &protocols::HidField::name);
  if (found == profile.channels.end()) {
    throw std::invalid_argument(
        fmt::format("the profile of {} has no channel {} (must have one)", profile.name, name));
  }
  return *found;
}

}  // namespace

FieldMachine::FieldMachine(const BenchDescription& bench, double ratio, const AskOperator& ask)
    : bench_(bench), ask_(ask), stale_after_(StaleAfter(bench)) {
  if (bench_.devices.empty()) {
    throw CampaignError(
        ExitCode::kWrongInput,
        fmt::format("{}: error: the bench has no devices (expected devices, channels and a drive for "
                    "each servo, or simulated: true)",
                    bench_.file_name));
  }
  try {
    Open(ratio);
  } catch (...) {
    Close();
    throw;
  }
}

void FieldMachine::Open(double ratio) {
  try {
    OpenBuses();
    StartDeviceSide(ratio);
    OpenHid();
    OpenCamera();
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

FieldMachine::~FieldMachine() { Close(); }

void FieldMachine::Close() noexcept {
  // The drives come to rest while everything that they need is still there.
  modbus_servos_.clear();
  for (auto& [name, bus] : buses_) bus.thread.reset();
  sampler_.reset();
  sources_.clear();
  modbus_.clear();
  hid_.clear();
  pendant_.reset();
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
    next += device_side_->step();
    pace.SleepUntil(next);
    next = std::max(next, pace.Now() - device_side_->step());
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
    bus.served = std::make_unique<DriveBus>(*bus.bus, clock_, std::move(bus.drives), [this] {
      return pendant_ && pendant_->Actual().state != PendantState::kReleased;
    });
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

void FieldMachine::OpenHid() {
  for (const DeviceDescription& device : bench_.devices) {
    if (device.kind == Kind::kHid) {
      OneHid& hid = hid_[device.name];
      hid.profile = ReadHidProfile(device.file);
      hid.channels = std::make_unique<HidChannels>(hid.profile, clock_);
    } else if (device.kind == Kind::kPendant) {
      const HidProfile profile = ReadHidProfile(device.file);
      pendant_ = std::make_unique<Pendant>(
          PendantProfile{profile.device, FieldNamed(profile, "quick_stop"), FieldNamed(profile, "reset"),
                         FieldNamed(profile, "start"), profile.good_for},
          clock_);
    } else if (device.kind == Kind::kStoContact) {
      const HidProfile profile = ReadHidProfile(device.file);
      sto_contact_ = std::make_unique<StoContact>(profile.device, FieldNamed(profile, "contact"), clock_);
    }
  }
}

void FieldMachine::OpenCamera() {
  for (const DeviceDescription& device : bench_.devices) {
    if (device.kind != Kind::kCamera) continue;
    CameraSettings settings;
    // "0" is the first camera of the machine; anything else a file.
    const bool is_number = device.address.find_first_not_of("0123456789") == std::string::npos;
    if (is_number) {
      settings.source = std::stoi(device.address);
    } else {
      settings.source = device.address;
    }
    camera_ = std::make_unique<Camera>(settings, clock_);
  }
}

bool FieldMachine::QuickStopPressed() noexcept {
  if (!pendant_) return false;
  const bool pressed = pendant_->Actual().state != PendantState::kReleased;
  if (pressed && !was_pressed_ && sto_contact_) sto_contact_->Asked(clock_.Now());
  was_pressed_ = pressed;
  return pressed;
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

}  // namespace strainwave::bench
