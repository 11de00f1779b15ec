// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <tuple>

#include <fmt/format.h>

#include "bench/configuration/read_register_map.h"
#include "bench/devices/monotonic_clock.h"
#include "bench/machines/device_side/modbus_device.h"
#include "bench/machines/device_side/modbus_servo_model.h"
#include "bench/machines/device_side/stream_server.h"
#include "tests/checkout.h"
#include "tests/schedules/schedule_text.h"
#include "tests/simulation/program.h"

namespace strainwave::bench {

/// A bench that stands still, its drives and thermometers on Modbus TCP, its encoders and torque as a stream
/// in blocks of one length; and the files that describe it.
class ModbusBench {
 public:
  static constexpr double kRate_hz = 1000.0;

  struct Servo {
    explicit Servo(const ModbusProfile& profile) : model(profile.map, *profile.servo), map(profile.map) {}

    MonotonicClock clock;
    ModbusServoModel model;
    protocols::modbus::RegisterMap map;
    std::atomic<double> fault_code{0.0};
    ModbusDevice device{
        map,
        1,
        {[this](std::size_t index) {
           return map.registers[index].name == "fault_code" ? fault_code.load()
                                                            : model.Read(index, clock.Now());
         },
         [this](std::size_t index, double value) { return model.Write(index, value, clock.Now()); },
         [this] { model.Hear(clock.Now()); }},
        ModbusDevice::Tcp{}};
  };

  explicit ModbusBench(std::uint32_t block_samples) : stream_(Encoders(block_samples), "127.0.0.1", 0) {
    std::ofstream(folder_ / "servo.yaml") << ServoText();
    feeder_ = std::thread([this, block_samples] { Feed(block_samples); });
  }
  ModbusBench(const ModbusBench&) = delete;
  ModbusBench& operator=(const ModbusBench&) = delete;
  ~ModbusBench() {
    ending_ = true;
    feeder_.join();
  }

  /// A bench file in `folder()`, with everything that it names.
  std::filesystem::path File(const std::string& stale_after) const {
    const auto path = folder_ / ("bench_" + std::to_string(++files_) + ".yaml");
    std::ofstream(path) << fmt::format(
        R"(bench: 1
name: devices elsewhere
simulated: false
control_period: 10 ms
stale_after: {}
driving_servo:
  serial: D
  peak_torque: 7.16 Nm
  peak_speed: 6000 rpm
  max_acceleration: 5000 rad/s2
  drive: {{device: driving}}
load_servo:
  serial: L
  peak_torque: 7.16 Nm
  peak_speed: 6000 rpm
  max_acceleration: 5000 rad/s2
  drive: {{device: load}}
load_reducer_ratio: 70
torque_transducer: {{serial: T, range: 100 Nm, calibration: C-T}}
input_encoder: {{serial: I, counts_per_rev: 1048576, accuracy: 20 arcsec, calibration: C-I}}
output_encoder: {{serial: O, counts_per_rev: 1048576, accuracy: 2.5 arcsec, calibration: C-O}}
devices:
  - {{name: driving, kind: modbus, address: "tcp:127.0.0.1:{}", registers: servo.yaml}}
  - {{name: load, kind: modbus, address: "tcp:127.0.0.1:{}", registers: servo.yaml}}
  - {{name: thermometers, kind: modbus, address: "tcp:127.0.0.1:{}", registers: "{}/strainwave_climate.yaml"}}
  - {{name: encoders, kind: stream, address: "tcp:127.0.0.1:{}"}}
channels:
  - {{channel: input_angle, device: encoders, source: input_angle_deg}}
  - {{channel: output_angle, device: encoders, source: output_angle_deg}}
  - {{channel: output_torque, device: encoders, source: torque_Nm}}
  - {{channel: gear_temperature, device: thermometers, source: gear_temperature_degC}}
  - {{channel: ambient_temperature, device: thermometers, source: ambient_temperature_degC}}
)",
        stale_after, driving.device.port(), load.device.port(), thermometers.port(), Profiles(),
        stream_.port());
    return path;
  }
  const ScratchFolder& folder() const { return folder_; }
  /// The encoders send nothing any more, though their connection stands.
  void set_mute(bool mute) { mute_ = mute; }

 private:
  static std::string Profiles() { return SourceFolder() + "/bench/devices/profiles"; }

  // As it is shipped, with a watchdog that is proven sooner.
  static std::string ServoText() {
    return schedules::With(WholeFile(Profiles() + "/modbus_servo_drive.yaml"), "watchdog_time: 200 ms",
                           "watchdog_time: 100 ms");
  }
  static daq::acquisition::SourceDescription Encoders(std::uint32_t block_samples) {
    daq::acquisition::SourceDescription source;
    source.name = "encoders";
    source.type = daq::acquisition::SampleType::kInt32;
    source.rate_hz = kRate_hz;
    source.most_samples_a_block = block_samples;
    for (const auto& [name, unit, sensor] : {std::tuple{"input_angle_deg", "deg", "I"},
                                             {"output_angle_deg", "deg", "O"},
                                             {"torque_Nm", "Nm", "T"}}) {
      daq::acquisition::ChannelDescription channel;
      channel.name = name;
      channel.unit = unit;
      channel.sensor_serial = sensor;
      channel.calibration.id = std::string("C-") + sensor;
      channel.calibration.sensitivity = 1000.0;
      source.channels.push_back(channel);
    }
    return source;
  }

  void Feed(std::uint32_t samples) {
    const auto channels = static_cast<std::uint32_t>(stream_.description().channels.size());
    daq::acquisition::SampleBlock block(std::size_t{channels} * samples);
    block.header.channels = channels;
    block.header.type = daq::acquisition::SampleType::kInt32;
    block.header.rate_hz = kRate_hz;
    block.header.samples = samples;
    std::uint64_t counter = 0;
    auto next = std::chrono::steady_clock::now();
    while (!ending_) {
      next += std::chrono::milliseconds(samples);
      std::this_thread::sleep_until(next);
      block.header.device_counter = counter;
      block.header.device_time = std::chrono::milliseconds(counter);
      for (std::uint32_t& word : block.words()) word = (word + 1) % 3;  // noise
      counter += samples;
      if (!mute_) stream_.Push(block);
    }
  }

  ScratchFolder folder_;
  mutable int files_{};

 public:
  ModbusProfile profile = ParseModbusProfile(ServoText(), "servo.yaml");
  Servo driving{profile};
  Servo load{profile};
  ModbusDevice thermometers{
      ReadModbusProfile(Profiles() + "/strainwave_climate.yaml").map,
      1,
      {[](std::size_t index) { return index == 0 ? 30.0 : 22.0; }, [](std::size_t, double) { return true; }},
      ModbusDevice::Tcp{}};

 private:
  StreamServer stream_;
  std::atomic<bool> ending_{};
  std::atomic<bool> mute_{};
  std::thread feeder_;
};

}  // namespace strainwave::bench
