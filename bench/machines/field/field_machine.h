// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/configuration/bench_description.h"
#include "bench/configuration/commissioning_file.h"
#include "bench/controller/phase_runner.h"
#include "bench/devices/camera/camera.h"
#include "bench/devices/can/candump_log.h"
#include "bench/devices/can/socket_can_bus.h"
#include "bench/devices/canopen/drive_bus_thread.h"
#include "bench/devices/hid/hid_channels.h"
#include "bench/devices/hid/pendant.h"
#include "bench/devices/hid/sto_contact.h"
#include "bench/devices/modbus/modbus_channels.h"
#include "bench/devices/modbus/modbus_client.h"
#include "bench/devices/modbus/modbus_servo_drive.h"
#include "bench/devices/modbus/modbus_switch.h"
#include "bench/devices/modbus/modbus_watchdog_proof.h"
#include "bench/devices/monotonic_clock.h"
#include "bench/machines/device_side/played_bench.h"
#include "bench/machines/field/field_sampler.h"
#include "bench/machines/field/source_reader.h"
#include "bench/realtime/realtime_mutex.h"
#include "bench/roles/ask_operator.h"
#include "bench/roles/bench_machine.h"

namespace strainwave::bench {

/// A bench of metal: the devices that its file names, joined to the roles. Where a drive's bus is
/// `in_process`, the device side stands in for the whole bench within this program, on real time and the same
/// protocols.
class FieldMachine final : public BenchMachine {
 public:
  enum class Use {
    kMove,  // the watchdogs of drives on Modbus are proven first: torque comes on at zero, with the brake on
    kLook,
  };

  /// Connects to every device and sets the drives up; nothing moves.
  /// @param ratio  of the gear, for the device side.
  /// @throws BenchError with what is missing or refuses, in words.
  FieldMachine(const BenchDescription& bench, double ratio, const AskOperator& ask, Use use = Use::kMove);
  ~FieldMachine() override;

  BenchDevices Devices() override;
  /// What the encoders have been counted to, over the ends of their 32 bits.
  std::span<const std::byte> Memory() override;
  void RestoreMemory(std::span<const std::byte> memory) override;
  void MountBlank(bool mounted) override;
  std::vector<ChannelCalibration> Calibrations() const override;
  std::vector<SourceTotals> Sources() const override;
  void StartRecording(const RecordingRequest& request) override;
  std::vector<RecordedSource> StopRecording() override;
  std::string Troubles() const override;
  std::vector<BadChannel> BadChannels() const override;
  std::string AwaitValues(const std::function<bool()>& given_up) override;
  std::string MissingForStart() const override;
  bool StartKeyHeld() const override;
  std::vector<Finding> Findings() const override;
  std::vector<std::string> TakeNotes() override;
  void TakePicture(const std::filesystem::path& file) override;
  void LogBuses(const std::filesystem::path& folder) override;
  void KeepBusLogs(const std::filesystem::path& stem) override;
  void KeepStreams(const std::filesystem::path& stem, const daq::Attributes& attributes) override;

  /// The devices that live within the program; null where they are elsewhere. For tests that put faults in.
  DeviceSide* device_side() noexcept { return played_ ? played_->devices() : nullptr; }

  /// How long each drive takes to stop when this program is gone: those on CAN by turning the input and
  /// falling silent, after which they are set up anew; those on Modbus as their watchdogs were proven at the
  /// start.
  /// @throws BenchError with what kept it from being measured.
  std::vector<MeasuredStop> MeasureStopTime(double input_speed_rad_per_s, const schedules::Limits& limits,
                                            const std::atomic<StopRequest>& request);

  /// Devices in words, each with its state: what `bench check` prints.
  struct DeviceState {
    std::string device;
    std::string state;
    bool good{};
    std::vector<std::pair<std::string, std::string>> facts{};  // more of it: {"brake", "on"}
  };
  std::vector<DeviceState> States() const;

 private:
  struct OneBus {
    std::unique_ptr<CanBus> own;  // null where it is played
    CanBus* bus{};
    std::unique_ptr<CanBus> listener;  // the log's own; null where it is played
    std::unique_ptr<CandumpLog> log;
    std::uint64_t lost_in_log{};  // told so far
    std::vector<CanopenServoSettings> drives;
    DriveBusCounts told;  // in notes
    std::unique_ptr<DriveBus> served;
    std::unique_ptr<DriveBusThread> thread;
  };

  static constexpr std::chrono::seconds kCommissioning{20};

  void Open();
  void Close() noexcept;
  void OpenBuses();
  SocketCanSettings SocketCanOf(const DeviceDescription& device) const;
  void NoteBusTroubles(std::vector<std::string>& notes);
  void NoteSyncs(std::vector<std::string>& notes);
  void NoteBusLogs(std::vector<std::string>& notes);
  void OpenDrives();
  void CheckPeriod(const CanopenServoSettings& servo) const;
  void IdentifyDrives(OneBus& bus);
  void SetOpen(bool open) noexcept;
  bool IsSupervised() const noexcept;
  std::vector<std::pair<std::string, std::string>> FactsOf(const CanopenServo& servo) const;
  static std::vector<std::pair<std::string, std::string>> FactsOf(const ModbusServoDrive& servo);
  const MeasuredStop* StopOf(const std::string& servo) const;
  void CheckPolls(const protocols::modbus::RegisterMap& map, const std::string& name) const;
  ServoDrive& OpenModbusServo(const DeviceDescription& device, const std::string& name, double reducer);
  ModbusSettings ModbusSettingsOf(const DeviceDescription& device) const;
  void OpenSources();
  std::map<std::string, daq::acquisition::Calibration> DataSheetsAt(const std::string& device) const;
  void OpenModbus();
  void OpenHid();
  void OpenCamera();
  bool PendantHolds() const noexcept;
  bool QuickStopPressed() noexcept;
  FieldChannels Channels();
  std::function<ChannelValue()> ChannelFrom(const ChannelLink& link);
  std::function<ChannelValue()> ChannelOfRole(const ChannelLink& link);
  std::function<ChannelValue()> FromSource(const SourceReader& reader, std::size_t channel, double to_si);
  static std::optional<std::size_t> RegisterOf(const ModbusClient& client, const std::string& source);
  std::string ReasonOf(const ChannelLink& link) const;
  std::chrono::nanoseconds LongestToFirstValue() const;
  std::vector<std::string> TooSlow() const;
  std::vector<std::string> NotYet() const;
  const DeviceDescription& Named(const std::string& name) const;

  BenchDescription bench_;
  double ratio_;  // of the gear
  AskOperator ask_;
  Use use_;
  std::vector<MeasuredStop> stops_;                // as kept beside the bench file
  std::map<std::string, std::string> identities_;  // of the drives that are there, by servo
  std::map<std::filesystem::path, std::vector<std::string>> eds_notes_;  // by the file of the drive's profile
  std::map<std::string, WatchdogProof> proofs_;                          // the same
  std::chrono::nanoseconds stale_after_;  // an older value of a channel is none
  MonotonicClock clock_;
  std::unique_ptr<PlayedBench> played_;  // before what uses its ends, so that it outlives that
  std::map<std::string, OneBus> buses_;
  std::map<std::string, std::unique_ptr<ModbusServoDrive>> modbus_servos_;  // by what people call them
  // Drives ask, from threads of their own, whether all others are supervised, while these come and go.
  mutable RealtimeMutex open_mutex_;
  bool is_open_{};  // all drives are known, and none is gone yet
  std::unique_ptr<ModbusSwitch> shunt_;
  std::map<std::string, std::unique_ptr<ModbusClient>> modbus_;
  std::map<std::string, std::unique_ptr<ModbusTorqueAmplifier>> amplifiers_;
  std::map<std::string, std::unique_ptr<ModbusTemperatureController>> chambers_;
  std::map<std::string, std::unique_ptr<SourceReader>> sources_;
  std::vector<std::int64_t> turns_;  // of all sources in turn: what `Memory` shows
  struct OneHid {
    HidProfile profile;
    std::unique_ptr<HidChannels> channels;
  };
  std::map<std::string, OneHid> hid_;
  std::unique_ptr<Pendant> pendant_;
  std::unique_ptr<StoContact> sto_contact_;
  std::unique_ptr<Camera> camera_;
  bool was_pressed_{};  // of the control thread
  // Of the bench's channels those that devices feed by themselves.
  std::vector<std::pair<const ChannelLink*, std::function<ChannelValue()>>> links_;
  std::unique_ptr<FieldSampler> sampler_;
  ServoDrive* driving_{};
  ServoDrive* load_{};
};

}  // namespace strainwave::bench
