// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "bench/configuration/bench_description.h"
#include "bench/devices/camera/camera.h"
#include "bench/devices/can/in_process_can_bus.h"
#include "bench/devices/canopen/drive_bus_thread.h"
#include "bench/devices/device_side/device_side.h"
#include "bench/devices/field/field_sampler.h"
#include "bench/devices/field/source_reader.h"
#include "bench/devices/hid/hid_channels.h"
#include "bench/devices/hid/pendant.h"
#include "bench/devices/hid/sto_contact.h"
#include "bench/devices/modbus/modbus_client.h"
#include "bench/devices/modbus/modbus_servo_drive.h"
#include "bench/devices/monotonic_clock.h"
#include "bench/roles/ask_operator.h"
#include "bench/roles/bench_machine.h"

namespace strainwave::bench {

/// A bench of metal: the devices that its file names, joined to the roles. Where a CAN bus is `in_process`,
/// the device side stands in for the whole bench within this program, on real time and the same protocols.
class FieldMachine final : public BenchMachine {
 public:
  /// Connects to every device and sets the drives up; nothing moves.
  /// @param ratio  of the gear, for the device side.
  /// @throws CampaignError with what is missing or refuses, in words.
  FieldMachine(const BenchDescription& bench, double ratio, const AskOperator& ask);
  ~FieldMachine() override;

  BenchDevices Devices() override;
  void MountBlank(bool mounted) override;
  std::string Troubles() const override;
  std::string MissingForStart() const override;
  std::vector<std::string> TakeNotes() override;
  void TakePicture(const std::filesystem::path& file) override;

  /// The devices that live within the program; null where they are elsewhere. For tests that put faults in.
  DeviceSide* device_side() noexcept { return device_side_.get(); }

  /// Devices in words, each with its state: what `bench check` prints.
  struct DeviceState {
    std::string device;
    std::string state;
    bool good{};
  };
  std::vector<DeviceState> States() const;

 private:
  struct OneBus {
    std::unique_ptr<InProcessCanBus> in_process;
    std::unique_ptr<CanBus> own;
    CanBus* bus{};
    std::vector<CanopenServoSettings> drives;
    std::unique_ptr<DriveBus> served;
    std::unique_ptr<DriveBusThread> thread;
  };

  void Open(double ratio);
  void Close() noexcept;
  void OpenBuses();
  void StartDeviceSide(double ratio);
  void RunDeviceSide();
  void OpenDrives();
  ServoDrive& OpenDrive(const ServoDescription& servo, const std::string& name);
  void OpenSources();
  void OpenModbus();
  void OpenHid();
  void OpenCamera();
  bool QuickStopPressed() noexcept;
  FieldChannels Channels();
  std::function<ChannelValue()> ChannelFrom(const ChannelLink& link);
  const DeviceDescription& Named(const std::string& name) const;
  std::string AddressOf(const DeviceDescription& device) const;

  BenchDescription bench_;
  AskOperator ask_;
  std::chrono::nanoseconds stale_after_;  // an older value of a channel is none
  MonotonicClock clock_;
  std::map<std::string, OneBus> buses_;
  std::unique_ptr<DeviceSide> device_side_;
  std::atomic<bool> ending_{};
  std::thread device_side_thread_;
  std::vector<std::unique_ptr<ModbusServoDrive>> modbus_servos_;
  std::map<std::string, std::unique_ptr<ModbusClient>> modbus_;
  std::map<std::string, std::unique_ptr<SourceReader>> sources_;
  struct OneHid {
    HidProfile profile;
    std::unique_ptr<HidChannels> channels;
  };
  std::map<std::string, OneHid> hid_;
  std::unique_ptr<Pendant> pendant_;
  std::unique_ptr<StoContact> sto_contact_;
  std::unique_ptr<Camera> camera_;
  bool was_pressed_{};  // of the control thread
  std::unique_ptr<FieldSampler> sampler_;
  ServoDrive* driving_{};
  ServoDrive* load_{};
};

}  // namespace strainwave::bench
