// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>

#include "analysis/units.h"
#include "bench/configuration/read_register_map.h"
#include "bench/devices/modbus/modbus_servo_drive.h"
#include "bench/devices/modbus/modbus_watchdog_proof.h"
#include "bench/machines/device_side/modbus_device.h"
#include "bench/machines/device_side/modbus_servo_model.h"
#include "tests/bench/modbus/modbus_helpers.h"
#include "tests/checkout.h"

namespace strainwave::bench {

using namespace std::chrono_literals;
using protocols::PowerState;
using Kind = ModbusDeviceFault::Kind;

/// A drive of the bench, and the inside of the servo that it talks to over TCP.
class Servo : public testing::Test {
 protected:
  Servo() {
    settings_.port = ModbusTcpPort{"127.0.0.1", device_.port()};
    settings_.answer_time = 500ms;
    settings_.retries = 0;
    settings_.first_pause = 10ms;
    settings_.longest_pause = 50ms;
    // None of its tests but the watchdog's waits for it, and the machine of the tests computes for others
    // too.
    profile_.servo->watchdog_time = 2s;
  }

  // The control loop goes on calling while it waits, as on a bench.
  bool UntilCalling(ServoDrive& drive, auto&& condition) {
    return Until([&] { return drive.Actual(), condition(); });
  }
  bool IsEnabled(ServoDrive& drive) {
    return UntilCalling(drive, [&] { return drive.Actual().power == PowerState::kOperationEnabled; });
  }
  void RunAt(ServoDrive& drive, double speed_rad_per_s) {
    drive.Enable(DriveMode::kSpeed);
    ASSERT_TRUE(IsEnabled(drive));
    drive.SetBrake(false);
    ASSERT_TRUE(UntilCalling(drive, [&] {
      drive.CommandSpeed(speed_rad_per_s);
      const DriveActual actual = drive.Actual();
      return std::abs(actual.speed_rad_per_s - speed_rad_per_s) < 0.01 && !actual.brake_engaged;
    }));
  }
  bool IsSafe() {
    return model_.power(clock_.Now()) != PowerState::kOperationEnabled && model_.brake_engaged();
  }
  std::unique_ptr<ModbusServoDrive> Drive(std::chrono::nanoseconds patience = 10s) {
    auto drive = std::make_unique<ModbusServoDrive>(
        settings_, profile_.map, *profile_.servo, clock_, [this] { return others_supervised_.load(); },
        patience);
    EXPECT_TRUE(Until([&] { return drive->Actual().time >= 0s; })) << drive->trouble();
    return drive;
  }

  SteadyBenchClock clock_;
  ModbusProfile profile_ =
      ReadModbusProfile(SourceFolder() + "/bench/devices/profiles/modbus_servo_drive.yaml");
  std::atomic<bool> silent_from_next_request_{false};
  std::atomic<bool> others_supervised_{true};
  const std::size_t position_at_ = *protocols::modbus::Find(profile_.map, "actual_position");
  std::atomic<double> position_rad_{0.0};  // not counted on: as the drive's register holds it
  const std::size_t fault_code_at_ = *protocols::modbus::Find(profile_.map, "fault_code");
  std::atomic<double> fault_code_{0.0};
  std::atomic<bool> takes_resets_{true};
  std::atomic<bool> faults_when_enabled_{false};
  ModbusServoModel model_{profile_.map, *profile_.servo};
  ModbusDevice device_{profile_.map,
                       1,
                       {[this](std::size_t index) {
                          if (index == fault_code_at_) return fault_code_.load();
                          return index == position_at_ ? position_rad_.load()
                                                       : model_.Read(index, clock_.Now());
                        },
                        [this](std::size_t index, double value) {
                          const bool is_control = index == *protocols::modbus::Find(profile_.map, "control");
                          if (is_control && value == profile_.servo->control.reset_fault && !takes_resets_)
                            return true;
                          const bool taken = model_.Write(index, value, clock_.Now());
                          if (is_control && value == profile_.servo->control.enable && faults_when_enabled_)
                            model_.Fault();
                          return taken;
                        },
                        [this] {
                          if (silent_from_next_request_.exchange(false)) device_.Set({Kind::kSilence, -1});
                          model_.Hear(clock_.Now());
                        }},
                       ModbusDevice::Tcp{}};
  ModbusSettings settings_;
};

}  // namespace strainwave::bench
