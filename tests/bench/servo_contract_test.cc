// SPDX-License-Identifier: Apache-2.0
// What every kind of drive promises in the role of a servo, and what the watch over it finds when it breaks
// off.
#include <functional>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "bench/configuration/read_register_map.h"
#include "bench/devices/modbus/modbus_servo_drive.h"
#include "bench/devices/simulated/simulated_drive.h"
#include "bench/machines/device_side/modbus_device.h"
#include "bench/machines/device_side/modbus_servo_model.h"
#include "bench/safety/drive_watch.h"
#include "tests/bench/canopen/in_process_drives.h"
#include "tests/bench/real_time.h"
#include "tests/checkout.h"

namespace strainwave::bench::servo_contract_test {
namespace {

using protocols::PowerState;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr nanoseconds kStaleAfter = milliseconds(500);

// A drive as the bench sees it, and the same drive seen from its own side.
class Adapter {
 public:
  virtual ~Adapter() = default;
  virtual ServoDrive& drive() = 0;
  virtual nanoseconds Now() = 0;
  virtual void Step() = 0;  // a little time goes by
  virtual bool is_enabled() = 0;
  virtual bool is_braked() = 0;
  virtual double torque_set_point() = 0;  // in units of its own
  virtual void DropOut() = 0;             // of operation enabled, without a fault
  virtual void FallSilent() = 0;

  /// The control loop goes on asking while it waits.
  bool Until(const std::function<bool()>& condition) {
    const nanoseconds end = Now() + std::chrono::seconds(20);
    while (Now() < end) {
      drive().Actual();
      if (condition()) return true;
      Step();
    }
    return false;
  }
};

class Simulated final : public Adapter {
 public:
  ServoDrive& drive() override { return drive_; }
  nanoseconds Now() override { return now_; }
  void Step() override {
    now_ += milliseconds(10);
    drive_.StepPowerState();
    if (!silent_) drive_.Report(now_, 0.0, 0.0, 0.0);
  }
  bool is_enabled() override { return drive_.enabled(); }
  bool is_braked() override { return drive_.brake_engaged(); }
  double torque_set_point() override { return drive_.set_point(); }
  void DropOut() override { drive_.PowerCut(); }
  void FallSilent() override { silent_ = true; }

 private:
  SimulatedDrive drive_{true};
  nanoseconds now_{};
  bool silent_{};
};

class OnCanopen final : public Adapter {
 public:
  OnCanopen() { drives_.Commission(); }
  ServoDrive& drive() override { return drives_.driving(); }
  nanoseconds Now() override { return drives_.clock.now; }
  void Step() override { drives_.Run(milliseconds(4)); }
  bool is_enabled() override {
    return drives_.motors[0].command.loop != protocols::canopen::device::DriveLoop::kOff;
  }
  bool is_braked() override { return drives_.motors[0].command.brake_engaged; }
  double torque_set_point() override { return drives_.motors[0].command.torque_permille; }
  void DropOut() override { drives_.motors[0].reading.safe_torque_off = true; }
  void FallSilent() override { drives_.nodes[0]->faults().silent = true; }

 private:
  InProcessDrives drives_;
};

class OnModbus final : public Adapter {
 public:
  explicit OnModbus(bool tcp) {
    const ModbusDevice::Behaviour behaviour{
        [this](std::size_t index) { return model_.Read(index, clock_.Now()); },
        [this](std::size_t index, double value) { return model_.Write(index, value, clock_.Now()); },
        [this] { model_.Hear(clock_.Now()); }};
    ModbusSettings settings;
    if (tcp) {
      device_ = std::make_unique<ModbusDevice>(profile_.map, 1, behaviour, ModbusDevice::Tcp{});
      settings.port = ModbusTcpPort{"127.0.0.1", device_->port()};
    } else {
      device_ = std::make_unique<ModbusDevice>(profile_.map, 1, behaviour);
      settings.port = ModbusSerialLine{device_->path(), 115'200, 'N'};
    }
    drive_ = std::make_unique<ModbusServoDrive>(
        settings, profile_.map, *profile_.servo, clock_, [] { return true; }, std::chrono::seconds(10));
  }
  ServoDrive& drive() override { return *drive_; }
  nanoseconds Now() override { return clock_.Now(); }
  void Step() override { std::this_thread::sleep_for(milliseconds(1)); }
  bool is_enabled() override { return model_.power(clock_.Now()) == PowerState::kOperationEnabled; }
  bool is_braked() override { return model_.brake_engaged(); }
  double torque_set_point() override {
    return model_.Read(*protocols::modbus::Find(profile_.map, "torque_set_point"), clock_.Now());
  }
  void DropOut() override { model_.set_faults({.enable_input_open = true}); }
  void FallSilent() override { device_->Set({ModbusDeviceFault::Kind::kSilence, -1}); }

 private:
  SteadyBenchClock clock_;
  ModbusProfile profile_ =
      ReadModbusProfile(SourceFolder() + "/bench/devices/profiles/modbus_servo_drive.yaml");
  ModbusServoModel model_{profile_.map, *profile_.servo};
  std::unique_ptr<ModbusDevice> device_;
  std::unique_ptr<ModbusServoDrive> drive_;
};

class Contract : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const std::string kind = GetParam();
    if (kind == "Simulated") adapter_ = std::make_unique<Simulated>();
    if (kind == "Canopen") adapter_ = std::make_unique<OnCanopen>();
    if (kind == "ModbusTcp") adapter_ = std::make_unique<OnModbus>(true);
    if (kind == "ModbusRtu") adapter_ = std::make_unique<OnModbus>(false);
    ASSERT_TRUE(adapter_->Until([&] { return Age() < kStaleAfter && !IsEnabled(); }));
    watch_ = std::make_unique<DriveWatch>(adapter_->drive(), BenchServo::kLoad);
    watch_->Restart(adapter_->Now());
  }
  nanoseconds Age() { return adapter_->Now() - adapter_->drive().Actual().time; }
  bool IsEnabled() { return adapter_->drive().Actual().power == PowerState::kOperationEnabled; }
  StopReason Check() { return watch_->Check(adapter_->drive().Actual(), adapter_->Now(), kStaleAfter); }
  void ComeUp(DriveMode mode = DriveMode::kTorque) {
    watch_->Enable(mode);
    ASSERT_TRUE(adapter_->Until([&] { return ExpectNone(Check()), IsEnabled(); }));
    watch_->SetBrake(false);
    ASSERT_TRUE(
        adapter_->Until([&] { return ExpectNone(Check()), !adapter_->drive().Actual().brake_engaged; }));
    EXPECT_FALSE(Check());
  }
  /// As a control loop does, every period: one that comes while the drive's last answer is old is not taken.
  bool TakesTorque(double torque_Nm) {
    return adapter_->Until([&] {
      ExpectNone(Check());
      adapter_->drive().CommandTorque(torque_Nm);
      return adapter_->torque_set_point() != 0.0;
    });
  }
  static void ExpectNone(const StopReason& reason) { EXPECT_FALSE(reason) << Describe(reason); }

  std::unique_ptr<Adapter> adapter_;
  std::unique_ptr<DriveWatch> watch_;
};

TEST_P(Contract, IsOffAndBrakedAndMovesNothingUntilItIsEnabled) {
  adapter_->drive().CommandTorque(1.0);
  const nanoseconds end = adapter_->Now() + milliseconds(200);
  ASSERT_TRUE(adapter_->Until([&] { return adapter_->Now() > end; }));
  EXPECT_FALSE(adapter_->is_enabled());
  EXPECT_TRUE(adapter_->is_braked());
  EXPECT_EQ(adapter_->torque_set_point(), 0.0);
}

TEST_P(Contract, IsEnabledWhenTheDriveItselfIsAndWithoutAJump) {
  ComeUp();
  EXPECT_TRUE(adapter_->is_enabled());
  EXPECT_FALSE(adapter_->is_braked());
  EXPECT_EQ(adapter_->torque_set_point(), 0.0);
  EXPECT_TRUE(TakesTorque(1.0));
}

TEST_P(Contract, StopsWithItsBrakeOnAndForgetsWhatWasAskedBefore) {
  ComeUp();
  ASSERT_TRUE(TakesTorque(1.0));
  watch_->QuickStop();
  ASSERT_TRUE(
      adapter_->Until([&] { return !adapter_->is_enabled() && adapter_->is_braked() && !IsEnabled(); }));
  EXPECT_FALSE(Check());
  ComeUp();
  EXPECT_EQ(adapter_->torque_set_point(), 0.0);
}

TEST_P(Contract, AnswersInAnotherModeOnlyWhenItIsInIt) {
  ComeUp();
  watch_->Enable(DriveMode::kSpeed);
  adapter_->drive().CommandTorque(1.0);
  ASSERT_TRUE(adapter_->Until([&] { return ExpectNone(Check()), IsEnabled(); }));
  const nanoseconds end = adapter_->Now() + milliseconds(200);
  ASSERT_TRUE(adapter_->Until([&] { return ExpectNone(Check()), adapter_->Now() > end; }));
}

TEST_P(Contract, ThatDropsOutIsFoundWithinTheTimeForOldValues) {
  ComeUp();
  adapter_->DropOut();
  const nanoseconds begin = adapter_->Now();
  ASSERT_TRUE(adapter_->Until([&] { return Check() || !IsEnabled(); }));
  EXPECT_LT(adapter_->Now() - begin, kStaleAfter);
  EXPECT_EQ(Check().cause, StopCause::kDriveDroppedOut);
}

TEST_P(Contract, ThatFallsSilentIsFoundWhateverItSaidLast) {
  ComeUp();
  adapter_->FallSilent();
  ASSERT_TRUE(adapter_->Until([&] { return static_cast<bool>(Check()); }));
  EXPECT_TRUE(Check().cause == StopCause::kDriveSilent || Check().cause == StopCause::kDriveDroppedOut);
}

TEST_P(Contract, ThatIsSilentWhileItIsOffIsFoundToo) {
  adapter_->FallSilent();
  const nanoseconds begin = adapter_->Now();
  ASSERT_TRUE(adapter_->Until([&] { return static_cast<bool>(Check()); }));
  EXPECT_EQ(Check().cause, StopCause::kDriveSilent);
  EXPECT_GE(adapter_->Now() - begin, kStaleAfter - milliseconds(50));
}

INSTANTIATE_TEST_SUITE_P(OfADrive, Contract,
                         testing::Values("Simulated", "Canopen", "ModbusTcp", "ModbusRtu"),
                         [](const auto& instance) { return std::string(instance.param); });

}  // namespace
}  // namespace strainwave::bench::servo_contract_test
