// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/model/plant_model.h"
#include "bench/configuration/bench_description.h"
#include "bench/devices/monotonic_clock.h"
#include "bench/devices/simulated/simulated_bench.h"
#include "bench/machines/device_side/modbus_device.h"
#include "bench/machines/device_side/served_load.h"
#include "bench/machines/device_side/stream_server.h"
#include "bench/realtime/realtime_mutex.h"
#include "bench/roles/bench_clock.h"
#include "bench/roles/can_bus.h"

namespace strainwave::bench {

/// The buses of the device side, by the name of the device in the bench file; one end each.
using DeviceSideBuses = std::map<std::string, std::vector<CanBus*>>;

/// A bench file's address of a CAN bus that is within this program; behind "tcp:" or "rtu:" that of a Modbus
/// device.
inline constexpr std::string_view kInProcess = "in_process";

/// Whether that is a device's address: the device side then stands in for the whole bench.
bool IsInProcess(const DeviceDescription& device);

/// The simulated bench as the separate devices that a bench file names: drives on CAN or Modbus, Modbus
/// servers, streams of samples, on the addresses that the bench would look for them at. Everything that the
/// simulated bench gets wrong, they get wrong.
///
/// A device of kind modbus has registers `gear_temperature` and `ambient_temperature`, both or one, and may
/// switch the transducer's shunt with a register `shunt`; of a stream, the channels are those that the bench
/// file takes from it.
class DeviceSide {
 public:
  /// @param buses  an end for each drive of a CAN device, in the order driving, load.
  /// @throws std::system_error for an address that cannot be had, BenchFileError for files that cannot be
  ///   used, std::invalid_argument for a device that this side cannot be.
  DeviceSide(const BenchDescription& bench, const analysis::model::PlantModel& model, DeviceSideBuses buses);
  DeviceSide(const DeviceSide&) = delete;
  DeviceSide& operator=(const DeviceSide&) = delete;
  ~DeviceSide();

  /// As many steps of simulated time as have passed; sends what came of them.
  void Step(std::chrono::nanoseconds now);
  /// How often to call it: as often as the bench reads its channels at most.
  std::chrono::nanoseconds step() const noexcept { return step_; }

  /// A command of a person who tries the bench out. From any thread.
  /// @return what was done. @throws std::invalid_argument with what was expected.
  std::string Do(const std::string& command);
  /// What there is to say, a line each.
  static const char* Commands();

  /// What is true of the shafts, whatever anybody reports: no torque and both brakes on. From any thread.
  bool StandsSafe();
  /// Since when, on the clock of `Step`; nothing while it is not so. From any thread.
  std::optional<std::chrono::nanoseconds> SafeSince();

  /// The address that a device really listens at: differs from the file's where that has port 0.
  std::string AddressOf(const std::string& device) const;

 private:
  struct Drive;
  struct Stream;

  void AddDrive(const BenchDescription& bench, const ServoDescription& servo, ServoDrive& simulated,
                double reducer_ratio, DeviceSideBuses& buses);
  void AddModbusDrive(const DeviceDescription& device, Drive& drive);
  void AddModbus(const DeviceDescription& device);
  void Serve(const DeviceDescription& device, const protocols::modbus::RegisterMap& map,
             ModbusDevice::Behaviour behaviour);
  void AddStream(const BenchDescription& bench, const analysis::model::PlantParameters& plant,
                 const DeviceDescription& device);
  void FillStream(Stream& stream, const Readings& readings);
  bool IsSafe();
  std::string DoDrive(const std::vector<std::string>& words);
  std::string DoCanopenDrive(Drive& drive, const std::vector<std::string>& words);
  std::string DoModbusDrive(Drive& drive, const std::vector<std::string>& words);
  std::string DoModbus(const std::vector<std::string>& words);
  std::string DoStream(const std::vector<std::string>& words);

  std::chrono::nanoseconds step_;
  MonotonicClock clock_;  // of the drives on Modbus
  SimulatedBench bench_;
  std::chrono::nanoseconds bench_now_{};  // of the simulation, in whole steps
  std::vector<std::unique_ptr<Drive>> drives_;
  std::map<std::string, std::unique_ptr<ModbusDevice>> modbus_;
  std::vector<std::unique_ptr<Stream>> streams_;
  int input_counts_;  // +1, or -1 where the encoder counts against the shaft
  int output_counts_;
  std::atomic<double> gear_temperature_degC_{};
  std::atomic<double> ambient_temperature_degC_{};
  std::atomic<double> output_torque_Nm_{};
  std::atomic<double> set_point_degC_{};  // of the chamber's controller, which heats nothing here
  std::atomic<bool> heats_{};
  std::atomic<bool> shunted_{};
  Injection injected_;  // into the sensors; what the simulation does not carry out, the streams do
  ServedLoad served_;
  VibrationBlock vibration_;
  bool vibrates_{};
  std::optional<std::chrono::nanoseconds> safe_since_;
  RealtimeMutex mutex_;  // between a step and a command
};

/// Steps the devices as real time goes on, until `ending`. After a hold-up it goes on from there.
/// @param exchange  called before and after each time: carries frames, where that is not done elsewhere.
/// @param period    how often they look at their buses, at least `DeviceSide::step`, which is also the
///   default. A long one saves a slow machine work: the shafts' steps, no coarser, are made several at a
///   time.
void RunInRealTime(DeviceSide& devices, const BenchClock& clock, const std::atomic<bool>& ending,
                   const std::function<void()>& exchange = {}, std::chrono::nanoseconds period = {});

}  // namespace strainwave::bench
