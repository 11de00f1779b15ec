// SPDX-License-Identifier: Apache-2.0
#include "bench/machines/field/field_machine.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "analysis/units.h"
#include "bench/configuration/bench_bounds.h"
#include "bench/configuration/read_bench_file.h"
#include "bench/configuration/read_drive_profile.h"
#include "bench/configuration/read_hid_profile.h"
#include "bench/configuration/read_register_map.h"
#include "bench/devices/canopen/drive_filters.h"
#include "bench/devices/modbus/modbus_address.h"
#include "bench/devices/tcp_address.h"
#include "bench/errors/bench_error.h"
#include "daq/acquisition/sources/iio_source.h"
#include "daq/acquisition/sources/tcp_stream_source.h"

namespace strainwave::bench {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Kind = DeviceDescription::Kind;

namespace {

constexpr milliseconds kBootUp{50};
// Few, so that a slow sensor's newest sample is not old by the time that the block is full.
constexpr std::uint32_t kIioBlock_samples = 32;

const protocols::HidField& FieldNamed(const HidProfile& profile, std::string_view name) {
  const auto found = std::ranges::find(profile.channels, name, &protocols::HidField::name);
  if (found == profile.channels.end()) {
    throw std::invalid_argument(
        fmt::format("the profile of {} has no channel {} (must have one)", profile.name, name));
  }
  return *found;
}

}  // namespace

FieldMachine::FieldMachine(const BenchDescription& bench, double ratio, const AskOperator& ask, Use use)
    : bench_(bench),
      ratio_(ratio),
      ask_(ask),
      use_(use),
      stops_(ReadCommissioningFile(CommissioningFileOf(bench.file_name))),
      stale_after_(static_cast<std::int64_t>(1e9 * bench.stale_after_s)) {
  if (bench_.devices.empty()) {
    throw BenchError(
        ExitCode::kWrongInput,
        fmt::format("{}: error: the bench has no devices (expected devices, channels and a drive for "
                    "each servo, or simulated: true)",
                    bench_.file_name));
  }
  try {
    Open();
  } catch (...) {
    Close();
    throw;
  }
}

void FieldMachine::Open() {
  try {
    played_ = std::make_unique<PlayedBench>(bench_, ratio_, clock_);
    OpenBuses();
    OpenHid();
    OpenCamera();
    OpenDrives();
    OpenModbus();
    OpenSources();
    sampler_ = std::make_unique<FieldSampler>(Channels(), clock_);
    SetOpen(true);
  } catch (const std::system_error& error) {
    throw BenchError(ExitCode::kMachineFailed, fmt::format("{}: error: {}", bench_.file_name, error.what()));
  } catch (const std::invalid_argument& error) {
    throw BenchError(ExitCode::kWrongInput, fmt::format("{}: error: {}", bench_.file_name, error.what()));
  } catch (const schedules::FileError& error) {
    throw BenchError(ExitCode::kWrongInput, error.what());
  }
}

FieldMachine::~FieldMachine() { Close(); }

void FieldMachine::Close() noexcept {
  // The drives come to rest while everything that they need is still there.
  for (const auto& [name, servo] : modbus_servos_) servo->QuickStop();
  SetOpen(false);
  for (auto& [name, bus] : buses_) bus.thread.reset();
  modbus_servos_.clear();
  for (auto& [name, bus] : buses_) bus.log.reset();
  sampler_.reset();
  sources_.clear();
  modbus_.clear();
  amplifiers_.clear();
  chambers_.clear();
  hid_.clear();
  pendant_.reset();
}

BenchDevices FieldMachine::Devices() { return {*driving_, *load_, *sampler_, clock_}; }

const DeviceDescription& FieldMachine::Named(const std::string& name) const {
  const DeviceDescription* const device = FindDevice(bench_.devices, name);
  if (device == nullptr) throw std::invalid_argument(fmt::format("there is no device {}", name));
  return *device;
}

void FieldMachine::OpenBuses() {
  for (const DeviceDescription& device : bench_.devices) {
    if (device.kind != Kind::kCanopen) continue;
    OneBus& bus = buses_[device.name];
    bus.bus = played_->Bus(device.name);
    if (bus.bus != nullptr) continue;
    SocketCanSettings settings = SocketCanOf(device);
    for (const ServoDescription* servo : {&bench_.driving_servo, &bench_.load_servo}) {
      if (servo->drive.device != device.name) continue;
      const auto filters = FiltersOfDrive(ReadDriveProfile(servo->drive.profile),
                                          static_cast<std::uint8_t>(servo->drive.node));
      settings.filters.insert(settings.filters.end(), filters.begin(), filters.end());
    }
    bus.own = std::make_unique<SocketCanBus>(settings);
    bus.bus = bus.own.get();
  }
}

ModbusSettings FieldMachine::ModbusSettingsOf(const DeviceDescription& device) const {
  ModbusSettings settings;
  settings.port = ParseModbusAddress(played_->AddressOf(device));
  settings.unit = device.unit;
  const ModbusConnection& said = device.connection;
  settings.answer_time = said.answer_time.value_or(settings.answer_time);
  settings.retries = said.retries.value_or(settings.retries);
  if (auto* const line = std::get_if<ModbusSerialLine>(&settings.port)) {
    line->baud = said.baud.value_or(line->baud);
    line->parity = said.parity.value_or(line->parity);
    line->stop_bits = said.stop_bits.value_or(line->stop_bits);
    line->answers_echo = said.answers_echo.value_or(line->answers_echo);
  }
  return settings;
}

// Set points reach a drive with SYNC alone; the loops that ask for them count on one in every period.
void FieldMachine::CheckPeriod(const CanopenServoSettings& servo) const {
  const auto sync_s = std::chrono::duration<double>(servo.profile.timing.sync_period).count();
  if (bench_.control_period_s >= sync_s) return;
  throw std::invalid_argument(fmt::format(
      "control_period = {:g} ms is shorter than sync_period = {:g} ms of the {} (must be at least "
      "as long, as set points reach a drive with SYNC)",
      1e3 * bench_.control_period_s, 1e3 * sync_s, servo.name));
}

// The state of a drive that is told more rarely than the bench asks for would never be fresh.
void FieldMachine::CheckPolls(const protocols::modbus::RegisterMap& map, const std::string& name) const {
  constexpr int kPolls = 2;  // one may come late by as much as it takes itself
  for (const char* needed : {"status", "actual_speed", "actual_torque"}) {
    const auto& value = map.registers[*protocols::modbus::Find(map, needed)];
    if (kPolls * value.poll_period <= stale_after_) continue;
    const auto ms = [](std::chrono::nanoseconds time) {
      return std::chrono::duration<double, std::milli>(time).count();
    };
    throw std::invalid_argument(fmt::format(
        "stale_after = {:g} ms is shorter than {} polls of '{}' of the {}, {:g} ms each (must be at least as "
        "long, as its state would be stale before it is read again)",
        ms(stale_after_), kPolls, needed, name, ms(value.poll_period)));
  }
}

ServoDrive& FieldMachine::OpenModbusServo(const DeviceDescription& device, const std::string& name,
                                          double reducer) {
  ModbusProfile profile = ReadModbusProfile(device.file);
  if (!profile.servo) {
    throw std::invalid_argument(
        fmt::format("{} describes no servo drive (must, as the {} is one)", device.file.string(), name));
  }
  profile.map = AtAxis(std::move(profile.map), *profile.servo, reducer);
  CheckPolls(profile.map, name);
  const ModbusSettings settings = ModbusSettingsOf(device);
  identities_[name] = fmt::format("{} unit {}", device.name, device.unit);
  if (use_ == Use::kMove) {
    // While nobody else is connected to the drive.
    ModbusLink link(settings, nullptr);
    link.Open();
    proofs_[name] = ProveWatchdog(link, profile.map, *profile.servo, clock_);
    if (!proofs_[name].proven) {
      throw BenchError(ExitCode::kMachineFailed, fmt::format("{}: error: the {} must not be enabled: {}",
                                                             bench_.file_name, name, proofs_[name].words));
    }
  }
  auto& servo = modbus_servos_[name];
  servo = std::make_unique<ModbusServoDrive>(settings, profile.map, *profile.servo, clock_,
                                             [this] { return IsSupervised(); });
  return *servo;
}

void FieldMachine::OpenDrives() {
  const std::tuple<const ServoDescription*, const char*, double, ServoDrive**> servos[] = {
      {&bench_.driving_servo, "driving servo", 1.0, &driving_},
      {&bench_.load_servo, "load servo", bench_.load_reducer_ratio, &load_}};
  for (const auto& [servo, name, reducer, place] : servos) {
    const DeviceDescription& device = Named(servo->drive.device);
    if (device.kind == Kind::kModbus) {
      *place = &OpenModbusServo(device, name, reducer);
      continue;
    }
    CanopenServoSettings settings;
    settings.name = name;
    settings.profile = AtAxis(ReadDriveProfile(servo->drive.profile), reducer, 1);
    eds_notes_[servo->drive.profile] = settings.profile.eds_notes;
    CheckPeriod(settings);
    settings.node_id = static_cast<std::uint8_t>(servo->drive.node);
    buses_.at(device.name).drives.push_back(std::move(settings));
  }
  for (auto& [name, bus] : buses_) {
    if (bus.drives.empty()) continue;
    IdentifyDrives(bus);
    bus.served = std::make_unique<DriveBus>(
        *bus.bus, clock_, std::move(bus.drives), [this] { return PendantHolds(); },
        [this] { return IsSupervised(); });
    for (std::size_t i = 0; i < bus.served->size(); ++i) {
      CanopenServo& servo = bus.served->servo(i);
      (servo.name() == "driving servo" ? driving_ : load_) = &servo;
    }
  }
  // Who looks leaves a fault for others to see; who starts a bench has seen it.
  const auto faults = use_ == Use::kMove ? DriveBusThread::Faults::kReset : DriveBusThread::Faults::kKeep;
  // The threads look at all drives: none is added any more.
  std::string troubles;
  for (auto& [name, bus] : buses_) {
    if (!bus.served) continue;
    bus.thread = std::make_unique<DriveBusThread>(*bus.served, clock_);
    // Drives that have just been switched on say so, and then have lost what was set up before.
    std::this_thread::sleep_for(kBootUp);
    std::string first = bus.thread->Commission(kCommissioning, faults);
    if (!first.empty()) first = bus.thread->Commission(kCommissioning, faults);
    troubles += first;
  }
  // Who looks sees them in the drives' states.
  if (!troubles.empty() && use_ == Use::kMove) {
    throw BenchError(ExitCode::kMachineFailed,
                     fmt::format("{}: error: the drives cannot be used\n{}", bench_.file_name, troubles));
  }
}

void FieldMachine::OpenModbus() {
  for (const DeviceDescription& device : bench_.devices) {
    if (device.kind == Kind::kTorqueAmplifier) {
      amplifiers_[device.name] = std::make_unique<ModbusTorqueAmplifier>(
          ModbusSettingsOf(device), ReadModbusProfile(device.file).map, clock_);
    } else if (device.kind == Kind::kTemperatureController) {
      auto& chamber = chambers_[device.name];
      chamber = std::make_unique<ModbusTemperatureController>(ModbusSettingsOf(device),
                                                              ReadModbusProfile(device.file).map, clock_);
      if (device.set_point_degC && use_ == Use::kMove) chamber->Heat(*device.set_point_degC);
    }
    const bool has_channels = std::ranges::any_of(
        bench_.channels, [&](const ChannelLink& link) { return link.device == device.name; });
    const SwitchLink& shunt = bench_.transducer.shunt;
    const bool switches = shunt.device == device.name;
    if (device.kind != Kind::kModbus || !(has_channels || switches)) continue;
    const protocols::modbus::RegisterMap map = ReadModbusProfile(device.file).map;
    if (switches) shunt_ = std::make_unique<ModbusSwitch>(map, shunt.source);
    modbus_[device.name] = std::make_unique<ModbusClient>(ModbusSettingsOf(device), map, clock_,
                                                          switches ? shunt_.get() : nullptr);
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
      if (profile.good_for > std::chrono::duration<double>(kLongestUnwatched_s)) {
        throw std::invalid_argument(
            fmt::format("line {}: pendant {} may be silent too long (good_for must be at most {:g} s)",
                        device.line, device.name, kLongestUnwatched_s));
      }
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

bool FieldMachine::PendantHolds() const noexcept {
  return pendant_ && pendant_->Actual().state != PendantState::kReleased;
}

bool FieldMachine::QuickStopPressed() noexcept {
  const bool pressed = PendantHolds();
  if (pressed && !was_pressed_ && sto_contact_) sto_contact_->Asked(clock_.Now());
  was_pressed_ = pressed;
  return pressed;
}

// By the names that the device has for its channels.
std::map<std::string, daq::acquisition::Calibration> FieldMachine::DataSheetsAt(
    const std::string& device) const {
  std::map<std::string, daq::acquisition::Calibration> all;
  for (const ChannelLink& link : bench_.channels) {
    if (link.device != device) continue;
    if (link.channel == "output_torque" && bench_.transducer.teds) all[link.source] = *bench_.transducer.teds;
    for (const AccelerometerDescription& sensor : bench_.accelerometers) {
      if (sensor.name == link.channel && sensor.teds) all[link.source] = *sensor.teds;
    }
  }
  return all;
}

void FieldMachine::OpenSources() {
  std::uint32_t number = 0;
  for (const DeviceDescription& device : bench_.devices) {
    if (device.kind == Kind::kStream) {
      const TcpAddress at = ParseTcpAddress(played_->AddressOf(device));
      daq::acquisition::TcpStreamSettings settings;
      settings.host = at.host;
      settings.port = static_cast<std::uint16_t>(at.port);
      settings.source = ++number;
      sources_[device.name] = std::make_unique<SourceReader>(
          std::make_unique<daq::acquisition::TcpStreamSource>(settings), clock_, DataSheetsAt(device.name));
    } else if (device.kind == Kind::kIio) {
      daq::acquisition::IioSettings settings;
      settings.uri = device.address;
      settings.device = device.iio_device;
      settings.samples_a_block = kIioBlock_samples;
      settings.source = ++number;
      sources_[device.name] = std::make_unique<SourceReader>(
          std::make_unique<daq::acquisition::IioSource>(settings), clock_, DataSheetsAt(device.name));
    }
  }
}

std::span<const std::byte> FieldMachine::Memory() {
  turns_.clear();
  for (const auto& [name, reader] : sources_) {
    const std::vector<std::int64_t> turns = reader->Turns();
    turns_.insert(turns_.end(), turns.begin(), turns.end());
  }
  return std::as_bytes(std::span(turns_));
}

// Of a bench whose encoders are others by now nothing is taken; the reference check says so.
void FieldMachine::RestoreMemory(std::span<const std::byte> memory) {
  if (memory.size() != Memory().size()) return;
  std::memcpy(turns_.data(), memory.data(), memory.size());
  std::size_t at = 0;
  for (const auto& [name, reader] : sources_) {
    const std::size_t count = reader->Turns().size();
    reader->GoOnFrom(std::span(turns_).subspan(at, count));
    at += count;
  }
}

void FieldMachine::MountBlank(bool mounted) {
  if (DeviceSide* const played = device_side()) {
    played->Do(mounted ? "blank on" : "blank off");
    return;
  }
  const std::string what =
      mounted ? "mount the rigid blank in the gear's place" : "put the gear back in its place";
  if (ask_ && ask_(what)) return;
  throw BenchError(
      ExitCode::kInterrupted,
      fmt::format("nobody has confirmed: {} (expected a person at the terminal; go on with --resume)", what));
}

}  // namespace strainwave::bench
