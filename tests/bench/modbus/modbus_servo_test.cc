// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/modbus/modbus_servo_fixture.h"

namespace strainwave::bench::modbus_servo_test {
namespace {

TEST_F(Servo, IsOffAndBrakedUntilItIsEnabled) {
  const auto drive = Drive();
  EXPECT_EQ(drive->Actual().power, PowerState::kSwitchOnDisabled);
  EXPECT_TRUE(drive->Actual().brake_engaged);
  drive->CommandSpeed(10.0);
  drive->CommandTorque(1.0);
  drive->Enable(DriveMode::kPosition);
  model_.TakeWritten();
  std::vector<std::string> written;
  ASSERT_TRUE(Until([&] {
    for (std::string& line : model_.TakeWritten()) written.push_back(std::move(line));
    return written.size() > 30;
  }));
  EXPECT_EQ(std::ranges::count(written, "control 1"), 0);
  EXPECT_EQ(std::ranges::count(written, "brake 1"), 0);
  EXPECT_GT(std::ranges::count(written, "speed_set_point 0"), 0);
}

TEST_F(Servo, SaysWhoItIsAndWhereItsBrakeIsToWhoeverLooks) {
  {
    const auto silent = Drive();
    EXPECT_EQ(silent->identity(), "");  // its map names nothing
    ASSERT_TRUE(Until([&] { return silent->tells_brake_engaged() == true; }));
  }
  protocols::modbus::RegisterMap map = profile_.map;
  for (const auto& [name, address] : {std::pair{"product_code", 8}, {"serial_number", 9}}) {
    map.registers.push_back(Named(name, address));
  }
  constexpr double kOfRegister[] = {402.0, 4711.0};
  std::atomic<double> brake{1.0};  // released
  const std::size_t brake_at = *protocols::modbus::Find(map, "brake");
  const std::size_t shipped = profile_.map.registers.size();
  ModbusDevice device(
      map, 1,
      {[&](std::size_t index) {
         if (index == brake_at) return brake.load();
         return index < shipped ? model_.Read(index, clock_.Now()) : kOfRegister[index - shipped];
       },
       [&](std::size_t index, double value) { return model_.Write(index, value, clock_.Now()); }},
      ModbusDevice::Tcp{});
  ModbusSettings settings = settings_;
  settings.port = ModbusTcpPort{"127.0.0.1", device.port()};
  const ModbusServoDrive drive(settings, map, *profile_.servo, clock_);
  ASSERT_TRUE(Until([&] { return drive.tells_brake_engaged() == false; }));
  EXPECT_EQ(drive.identity(), "product 402, serial 4711");
  brake = 0.0;
  EXPECT_TRUE(Until([&] { return drive.tells_brake_engaged() == true; }));
}

// docs/requirements.md R15.
TEST_F(Servo, IsNotEnabledWhileAnotherDriveWouldNotNoticeThatTheProgramIsGone) {
  const auto drive = Drive();
  others_supervised_ = false;
  model_.TakeWritten();
  drive->Enable(DriveMode::kSpeed);
  std::vector<std::string> written;
  ASSERT_TRUE(UntilCalling(*drive, [&] {
    for (std::string& line : model_.TakeWritten()) written.push_back(std::move(line));
    return written.size() > 30;
  }));
  EXPECT_EQ(std::ranges::count(written, "control 1"), 0);
  EXPECT_TRUE(IsSafe());
  others_supervised_ = true;
  ASSERT_TRUE(UntilCalling(*drive, [&] { return model_.TakeWritten().size() > 3; }));
  EXPECT_TRUE(IsSafe()) << "it must be asked for anew";
  drive->Enable(DriveMode::kSpeed);
  EXPECT_TRUE(IsEnabled(*drive));
}

// 32 bits of 0.001 deg are 11 930 turns.
TEST_F(Servo, CountsItsPositionOnWhereTheRegisterGoesOver) {
  const auto drive = Drive();
  const double whole_rad = RadFromDeg(0.001) * 4294967296.0;
  for (const double direction : {1.0, -1.0}) {
    const double from_rad = drive->Actual().position_rad;
    for (int i = 1; i <= 12; ++i) {
      const double expected_rad = from_rad + direction * i * whole_rad / 5.0;
      position_rad_ = std::remainder(expected_rad, whole_rad);
      ASSERT_TRUE(
          UntilCalling(*drive, [&] { return std::abs(drive->Actual().position_rad - expected_rad) < 0.01; }))
          << drive->Actual().position_rad << " instead of " << expected_rad;
    }
  }
}

TEST_F(Servo, RunsAtSpeedAndPullsTorque) {
  const auto drive = Drive();
  RunAt(*drive, 104.7);
  EXPECT_NEAR(model_.actual_speed_rad_per_s(clock_.Now()), 104.7, 0.001);
  drive->Disable();
  ASSERT_TRUE(UntilCalling(*drive, [&] { return drive->Actual().power == PowerState::kSwitchOnDisabled; }));
  drive->Enable(DriveMode::kTorque);
  ASSERT_TRUE(IsEnabled(*drive));
  EXPECT_EQ(drive->Actual().torque_Nm, 0.0) << "what was commanded before is gone";
  EXPECT_TRUE(UntilCalling(*drive, [&] {
    drive->CommandTorque(-12.5);
    return std::abs(drive->Actual().torque_Nm + 12.5) < 0.005;
  }));
}

TEST_F(Servo, StopsWithTorqueFirstAndNoSetPointAfterIt) {
  const auto drive = Drive();
  RunAt(*drive, 50.0);
  model_.TakeWritten();
  drive->QuickStop();
  drive->CommandSpeed(50.0);
  ASSERT_TRUE(UntilCalling(*drive, [&] { return IsSafe(); }));
  std::vector<std::string> written = model_.TakeWritten();
  const auto stop = std::ranges::find(written, "control 2");
  ASSERT_NE(stop, written.end());
  const std::vector<std::string> after(stop, written.end());
  EXPECT_LT(std::ranges::find(after, "control 2"), std::ranges::find(after, "brake 0"));
  for (const std::string& line : after) {
    EXPECT_FALSE(line.starts_with("speed_set_point") && line != "speed_set_point 0") << line;
    EXPECT_NE(line, "control 1");
    EXPECT_NE(line, "brake 1");
  }
}

TEST_F(Servo, AStopIsDoneEvenIfTheNextEnableFollowsAtOnce) {
  const auto drive = Drive();
  RunAt(*drive, 50.0);
  model_.TakeWritten();
  drive->QuickStop();
  drive->Enable(DriveMode::kSpeed);
  std::vector<std::string> written;
  ASSERT_TRUE(UntilCalling(*drive, [&] {
    for (std::string& line : model_.TakeWritten()) written.push_back(std::move(line));
    const auto off = std::ranges::find(written, "control 0");
    return std::find(off, written.end(), "control 1") != written.end();
  }));
  const auto off = std::ranges::find(written, "control 0");
  for (auto line = off; line != written.end(); ++line) {
    EXPECT_FALSE(line->starts_with("speed_set_point") && *line != "speed_set_point 0") << *line;
  }
}

TEST_F(Servo, OverTcpAStopDoesNotWaitForAnAnswerThatIsDue) {
  settings_.answer_time = 2s;
  const auto drive = Drive();
  RunAt(*drive, 50.0);
  model_.set_watchdog(ModbusServoModel::Watchdog::kNever);
  silent_from_next_request_ = true;
  ASSERT_TRUE(UntilCalling(*drive, [&] { return !silent_from_next_request_; }));  // its answer is due now
  drive->QuickStop();
  EXPECT_TRUE(
      UntilCalling(*drive, [&] { return model_.power(clock_.Now()) == PowerState::kQuickStopActive; }));
  EXPECT_EQ(drive->counts().timeouts, 0U);
}

// It hears everything: its torque goes off and its brake on, whatever it says to that.
TEST_F(Servo, AStopReachesADriveWhoseAnswersCannotBeUsed) {
  for (const Kind wrong : {Kind::kSilence, Kind::kHalf, Kind::kOtherUnit, Kind::kOtherTransaction}) {
    const auto drive = Drive();
    RunAt(*drive, 50.0);
    model_.set_watchdog(ModbusServoModel::Watchdog::kNever);
    device_.Set({wrong, -1});
    drive->QuickStop();
    EXPECT_TRUE(UntilCalling(*drive, [&] { return IsSafe(); })) << static_cast<int>(wrong);
    device_.Set({});
    model_.set_watchdog(ModbusServoModel::Watchdog::kWrites);
  }
}

// As on a line, where nothing tells that it has.
TEST_F(Servo, ThatRestartedWhileItWasOffIsGivenItsWatchdogTimeAgainBeforeItIsEnabled) {
  const auto drive = Drive();
  const std::size_t at = *protocols::modbus::Find(profile_.map, "watchdog_time");
  model_.Restart();
  EXPECT_EQ(model_.Read(at, clock_.Now()), 0.0);
  model_.TakeWritten();
  RunAt(*drive, 50.0);
  const std::vector<std::string> written = model_.TakeWritten();
  EXPECT_LT(std::ranges::find(written, "watchdog_time 2"), std::ranges::find(written, "control 1"));
  EXPECT_EQ(model_.Read(at, clock_.Now()), 2.0);
}

TEST_F(Servo, EveryWayOutLeavesTheDriveOffAndBraked) {
  {
    const auto drive = Drive();
    RunAt(*drive, 50.0);
    model_.set_watchdog(ModbusServoModel::Watchdog::kNever);
  }
  EXPECT_TRUE(IsSafe());
}

TEST_F(Servo, AControlLoopThatHangsIsNoticed) {
  const auto drive = Drive(300ms);
  RunAt(*drive, 50.0);
  model_.set_watchdog(ModbusServoModel::Watchdog::kNever);
  EXPECT_TRUE(Until([&] { return IsSafe(); })) << "nobody calls the drive";
  drive->CommandSpeed(50.0);
  EXPECT_TRUE(UntilCalling(*drive, [&] { return drive->Actual().power == PowerState::kQuickStopActive; }));
}

TEST_F(Servo, AfterALostConnectionItStaysOff) {
  const auto drive = Drive();
  RunAt(*drive, 50.0);
  model_.set_watchdog(ModbusServoModel::Watchdog::kNever);
  device_.Set({Kind::kHalf, 1});  // costs the connection
  ASSERT_TRUE(UntilCalling(*drive, [&] { return IsSafe(); }));
  ASSERT_TRUE(UntilCalling(*drive, [&] {
    drive->CommandSpeed(50.0);
    return drive->Actual().time > 0s && drive->trouble().empty() && drive->Actual().brake_engaged;
  }));
  model_.TakeWritten();
  std::vector<std::string> written;
  ASSERT_TRUE(UntilCalling(*drive, [&] {
    for (std::string& line : model_.TakeWritten()) written.push_back(std::move(line));
    return written.size() > 30;
  }));
  EXPECT_EQ(std::ranges::count(written, "control 1"), 0);
  EXPECT_EQ(std::ranges::count(written, "brake 1"), 0);
  EXPECT_TRUE(IsSafe());
  drive->QuickStop();
  RunAt(*drive, 20.0);
}

TEST_F(Servo, AFaultIsResetByCommandAndLeadsToOff) {
  const auto drive = Drive();
  RunAt(*drive, 50.0);
  model_.Fault();
  ASSERT_TRUE(UntilCalling(*drive, [&] { return drive->Actual().power == PowerState::kFault && IsSafe(); }));
  drive->ResetFault();
  ASSERT_TRUE(UntilCalling(*drive, [&] { return drive->Actual().power == PowerState::kSwitchOnDisabled; }));
  EXPECT_TRUE(IsSafe());
  RunAt(*drive, 20.0);
}

TEST_F(Servo, SaysAFaultWithItsCodeToWhoeverLooks) {
  const auto drive = Drive();
  EXPECT_EQ(drive->fault(), "");
  fault_code_ = 17.0;
  model_.Fault();
  EXPECT_TRUE(Until([&] { return drive->fault() == "in fault, code 17 (11h)"; })) << drive->fault();
}

TEST_F(Servo, WithoutAnswersItsStateIsTheLastOneAndGrowsOld) {
  const auto drive = Drive();
  ASSERT_TRUE(UntilCalling(*drive, [&] { return drive->Actual().power == PowerState::kSwitchOnDisabled; }));
  device_.Set({Kind::kSilence, -1});
  ASSERT_TRUE(UntilCalling(*drive, [&] { return clock_.Now() - drive->Actual().time > 300ms; }));
  const auto told = drive->Actual().time;
  ASSERT_TRUE(UntilCalling(*drive, [&] { return clock_.Now() - told > 400ms; }));
  EXPECT_EQ(drive->Actual().time, told);
  EXPECT_EQ(drive->Actual().power, PowerState::kSwitchOnDisabled);
  EXPECT_TRUE(UntilCalling(*drive, [&] { return !drive->Actual().brake_engaged; }));
}

TEST_F(Servo, WithoutAConnectionItsStateIsLongAgo) {
  device_.Set({Kind::kSilence, -1});
  ModbusServoDrive drive(settings_, profile_.map, *profile_.servo, clock_);
  const auto begin = clock_.Now();
  ASSERT_TRUE(UntilCalling(drive, [&] { return clock_.Now() - begin > 300ms; }));
  EXPECT_LT(drive.Actual().time, -59min);
  EXPECT_EQ(drive.Actual().power, PowerState::kNotReadyToSwitchOn);
}

// In another mode the drive is off for a while; what it said before is no answer to that.
TEST_F(Servo, IsNotEnabledInAnotherModeBeforeItSaysSoAnew) {
  const auto drive = Drive();
  RunAt(*drive, 50.0);
  for (const DriveMode mode : {DriveMode::kTorque, DriveMode::kSpeed}) {
    model_.TakeWritten();
    drive->Enable(mode);
    EXPECT_EQ(drive->Actual().power, PowerState::kSwitchedOn);
    drive->CommandSpeed(50.0);
    drive->CommandTorque(1.0);
    ASSERT_TRUE(IsEnabled(*drive));
    // Its way there leads through off; what was on the way to the drive before that was asked for before.
    const std::vector<std::string> written = model_.TakeWritten();
    const auto off = std::ranges::find(written, "control 0");
    ASSERT_NE(off, written.end());
    for (const std::string& line : std::ranges::subrange(off, written.end())) {
      EXPECT_FALSE(line.find("set_point") != std::string::npos && !line.ends_with(" 0")) << line;
    }
  }
}

TEST_F(Servo, BehindAReducerItsTorqueIsThatOfTheOutput) {
  constexpr double kReducer = 70.0;
  const auto map = AtAxis(profile_.map, *profile_.servo, kReducer);
  ModbusServoDrive drive(settings_, map, *profile_.servo, clock_);
  ASSERT_TRUE(UntilCalling(drive, [&] { return drive.Actual().time >= 0s; }));
  drive.Enable(DriveMode::kTorque);
  ASSERT_TRUE(IsEnabled(drive));
  std::vector<std::string> written;
  ASSERT_TRUE(UntilCalling(drive, [&] {
    drive.CommandTorque(42.0);
    for (std::string& line : model_.TakeWritten()) written.push_back(std::move(line));
    return std::ranges::count(written, "torque_set_point 0.6") > 0;
  })) << ::testing::PrintToString(written);
}

TEST_F(Servo, AWatchdogTimeThatReadsBackOtherwiseIsRefused) {
  for (const double time_s : {0.0, 5.0}) {
    model_.set_fixed_watchdog_time(time_s);
    ModbusServoDrive drive(settings_, profile_.map, *profile_.servo, clock_);
    drive.Enable(DriveMode::kSpeed);
    EXPECT_TRUE(Until([&] {
      return drive.trouble() ==
             "setting up: wrong answer: the watchdog time reads back as another than was written; the drive "
             "would "
             "not stop by itself";
    })) << drive.trouble();
    EXPECT_TRUE(IsSafe());
  }
}

}  // namespace
}  // namespace strainwave::bench::modbus_servo_test
