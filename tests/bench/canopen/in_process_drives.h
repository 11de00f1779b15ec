// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "analysis/units.h"
#include "bench/configuration/read_drive_profile.h"
#include "bench/devices/can/in_process_can_bus.h"
#include "bench/devices/canopen/drive_bus.h"
#include "protocols/canopen/drive_node.h"
#include "tests/bench/test_clock.h"
#include "tests/checkout.h"

namespace strainwave::bench {

/// A motor without a load that follows its set-point as fast as its acceleration lets it.
class FreeMotor final : public protocols::canopen::device::DrivePhysics {
 public:
  using Command_ = protocols::canopen::device::DriveCommand;

  protocols::canopen::device::DriveReading Read() noexcept override { return reading; }
  void Command(const Command_& wanted) noexcept override { command = wanted; }
  void ResetFault() noexcept override { reading.out_of_order = false; }

  void Step(double step_s) noexcept {
    using protocols::canopen::device::DriveLoop;
    constexpr double kMostStep = 65536.0 * 800.0;  // increments/s²
    double wanted = 0.0;
    switch (command.loop) {
      case DriveLoop::kOff:
        wanted = command.brake_engaged ? 0.0 : reading.speed_inc_per_s;
        break;
      case DriveLoop::kSpeed:
        wanted = command.speed_inc_per_s;
        break;
      case DriveLoop::kPosition:
        wanted = 20.0 * (command.position_inc - reading.position_inc);
        break;
      case DriveLoop::kTorque:
        reading.torque_permille = command.torque_permille;
        wanted = reading.speed_inc_per_s;
        break;
    }
    const double change =
        std::clamp(wanted - reading.speed_inc_per_s, -kMostStep * step_s, kMostStep * step_s);
    reading.speed_inc_per_s += change;
    reading.position_inc += reading.speed_inc_per_s * step_s;
  }

  protocols::canopen::device::DriveReading reading;
  Command_ command;
};

/// Two drives of our own on a bus within the process, and the bench's end of it. Time goes on by `Run`.
class InProcessDrives {
 public:
  InProcessDrives()
      : buses({.ends = 3}), profile(ReadDriveProfile(Profiles() / "strainwave_drive.yaml")), eds(ReadEds()) {
    for (std::size_t i = 0; i < 2; ++i) {
      nodes[i] = std::make_unique<protocols::canopen::device::DriveNode>(
          eds, static_cast<std::uint8_t>(i + 1), motors[i]);
    }
    bus = std::make_unique<DriveBus>(
        buses.end(0), clock,
        std::vector<CanopenServoSettings>{{"driving servo", profile, 1}, {"load servo", profile, 2}},
        [this] { return key_pressed; });
  }

  static std::filesystem::path Profiles() {
    return std::filesystem::path(SourceFolder()) / "bench/devices/profiles";
  }

  static protocols::canopen::EdsFile ReadEds() {
    std::ifstream file(Profiles() / "strainwave_drive.eds");
    std::ostringstream text;
    text << file.rdbuf();
    return protocols::canopen::ParseEds(text.str(), "strainwave_drive.eds");
  }

  CanopenServo& driving() { return bus->servo(0); }
  CanopenServo& load() { return bus->servo(1); }

  /// In steps of one SYNC period. `every_cycle` is the control loop: what does not call the drives is silent.
  template <typename EveryCycle>
  void Run(std::chrono::nanoseconds duration, EveryCycle every_cycle) {
    const auto until = clock.now + duration;
    while (clock.now < until) {
      every_cycle();
      if (bench_alive) bus->Cycle(clock.now);
      clock.now += bus->sync_period() / 2;
      buses.Exchange(clock.now);
      Devices();
      clock.now += bus->sync_period() / 2;
      buses.Exchange(clock.now);
    }
  }
  void Run(std::chrono::nanoseconds duration) {
    Run(duration, [this] {
      driving().Actual();
      load().Actual();
    });
  }

  void Commission() {
    Run(std::chrono::milliseconds(100));  // the drives boot up
    driving().Commission();
    load().Commission();
    Run(std::chrono::seconds(5));
  }

  void BringUp(ServoDrive& drive, DriveMode mode) {
    drive.Enable(mode);
    Run(std::chrono::milliseconds(500));
    drive.SetBrake(false);
    Run(std::chrono::milliseconds(50));
  }

  TestClock clock;
  InProcessCanBus buses;
  protocols::canopen::DriveProfile profile;
  protocols::canopen::EdsFile eds;
  std::array<FreeMotor, 2> motors;
  std::array<std::unique_ptr<protocols::canopen::device::DriveNode>, 2> nodes;
  std::unique_ptr<DriveBus> bus;
  bool bench_alive{true};
  bool key_pressed{};
  std::vector<protocols::CanFrame> sent_to_drives;  // as the first drive received them

 private:
  void Devices() {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      CanBus& end = buses.end(static_cast<int>(i) + 1);
      ReceivedFrame received;
      while (end.Receive(received)) {
        if (i == 0) sent_to_drives.push_back(received.frame);
        nodes[i]->OnFrame(received.frame, clock.now);
      }
      motors[i].Step(1e-9 * static_cast<double>(bus->sync_period().count()));
      nodes[i]->Poll(clock.now);
      protocols::CanFrame frame;
      while (nodes[i]->Next(frame)) end.Send(frame);
    }
  }
};

}  // namespace strainwave::bench
