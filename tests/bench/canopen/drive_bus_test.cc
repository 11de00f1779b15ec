// SPDX-License-Identifier: Apache-2.0
// The bench's servos against drives that were written from the standard by another hand, over a bus.
#include "bench/devices/canopen/drive_bus.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "bench/devices/canopen/bus_troubles.h"
#include "tests/bench/canopen/in_process_drives.h"

namespace strainwave::bench::drive_bus_test {
namespace {

using protocols::PowerState;
using protocols::canopen::DriveStage;
using protocols::canopen::DriveTrouble;
using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(DriveBus, CommissionsBothDrives) {
  InProcessDrives bench;
  EXPECT_EQ(bench.driving().report().stage, DriveStage::kOff);
  bench.Commission();
  for (CanopenServo* servo : {&bench.driving(), &bench.load()}) {
    EXPECT_EQ(servo->report().stage, DriveStage::kDisabled) << servo->report().words.data();
    EXPECT_EQ(servo->report().steps_done, servo->report().steps);
    EXPECT_TRUE(servo->Actual().brake_engaged);
    EXPECT_NE(servo->Actual().power, PowerState::kOperationEnabled);
  }
  EXPECT_EQ(bench.bus->counts().lost, 0U);
  EXPECT_EQ(bench.bus->counts().malformed, 0U);
}

TEST(DriveBus, SaysToItsDrivesThatItLives) {
  InProcessDrives bench;
  bench.Commission();
  bench.sent_to_drives.clear();
  bench.Run(seconds(1));
  int heartbeats = 0;
  int syncs = 0;
  for (const auto& frame : bench.sent_to_drives) {
    heartbeats += frame.id == 0x700 + 127 && frame.data[0] == 5 ? 1 : 0;
    syncs += frame.id == 0x80 ? 1 : 0;
  }
  // Every 50 ms, at the next SYNC of 4 ms.
  EXPECT_GE(heartbeats, 19);
  EXPECT_LE(heartbeats, 20);
  EXPECT_EQ(syncs, 250);
}

TEST(DriveBus, TurnsAMotorAtTheSpeedThatIsAskedFor) {
  InProcessDrives bench;
  bench.Commission();
  bench.BringUp(bench.driving(), DriveMode::kSpeed);
  EXPECT_EQ(bench.driving().Actual().power, PowerState::kOperationEnabled)
      << bench.driving().report().words.data();
  EXPECT_FALSE(bench.driving().Actual().brake_engaged);
  EXPECT_EQ(bench.driving().Actual().speed_rad_per_s, 0.0);
  bench.Run(seconds(1), [&] {
    bench.driving().CommandSpeed(RadPerSFromRpm(1000.0));
    bench.load().Actual();
  });
  EXPECT_NEAR(bench.motors[0].reading.speed_inc_per_s, 65536.0 * 1000.0 / 60.0, 1.0);
  EXPECT_NEAR(bench.driving().Actual().speed_rad_per_s, RadPerSFromRpm(1000.0), 1e-3);
  EXPECT_EQ(bench.motors[1].reading.speed_inc_per_s, 0.0);
}

TEST(DriveBus, KeepsPositionWhenItIsEnabledForPosition) {
  InProcessDrives bench;
  bench.motors[0].reading.position_inc = 3.25 * 65536.0;
  bench.Commission();
  bench.BringUp(bench.driving(), DriveMode::kPosition);
  EXPECT_NEAR(bench.motors[0].reading.position_inc, 3.25 * 65536.0, 1.0) << "the shaft jumped";
  const double from_rad = bench.driving().Actual().position_rad;
  EXPECT_NEAR(from_rad, 3.25 * kTwoPi, 1e-3);
  bench.Run(seconds(2), [&] {
    bench.driving().CommandPosition(from_rad + 1.0);
    bench.load().Actual();
  });
  EXPECT_NEAR(bench.driving().Actual().position_rad, from_rad + 1.0, 0.01);
}

TEST(DriveBus, StopsAndBrakesAndLetsNoSetPointThroughAfterwards) {
  InProcessDrives bench;
  bench.Commission();
  bench.BringUp(bench.driving(), DriveMode::kSpeed);
  bench.Run(milliseconds(500), [&] {
    bench.driving().CommandSpeed(100.0);
    bench.load().Actual();
  });
  bench.driving().QuickStop();
  bench.driving().CommandSpeed(100.0);  // a loop that has not noticed yet
  bench.Run(seconds(1));
  EXPECT_EQ(bench.motors[0].reading.speed_inc_per_s, 0.0);
  EXPECT_TRUE(bench.motors[0].command.brake_engaged);
  EXPECT_EQ(bench.driving().Actual().power, PowerState::kSwitchOnDisabled);
  EXPECT_EQ(bench.driving().report().trouble, DriveTrouble::kQuickStopAsked);
  // The next phase enables it again, from rest.
  bench.BringUp(bench.driving(), DriveMode::kSpeed);
  EXPECT_EQ(bench.driving().Actual().power, PowerState::kOperationEnabled);
  EXPECT_EQ(bench.motors[0].reading.speed_inc_per_s, 0.0) << "an old set-point fired";
}

TEST(DriveBus, StopsBetweenTwoSyncsWhenSomebodyCalls) {
  InProcessDrives bench;
  bench.Commission();
  bench.BringUp(bench.driving(), DriveMode::kSpeed);
  bench.sent_to_drives.clear();
  bench.driving().QuickStop();
  bench.bus->TakeOrders(bench.clock.now);
  bench.clock.now += bench.bus->sync_period() / 4;
  bench.buses.Exchange(bench.clock.now);
  ReceivedFrame received;
  bool quick_stop_came = false;
  while (bench.buses.end(1).Receive(received)) {
    const auto& frame = received.frame;
    EXPECT_NE(frame.id, 0x80U) << "no SYNC was due";
    // Controlword 0002h in the first RPDO.
    quick_stop_came =
        quick_stop_came || (frame.id == 0x201 && frame.data[0] == 0x02 && frame.data[1] == 0x00);
  }
  EXPECT_TRUE(quick_stop_came);
}

TEST(DriveBus, HoldsDrivesThatSomebodyElseStopped) {
  InProcessDrives bench;
  bench.Commission();
  bench.BringUp(bench.driving(), DriveMode::kSpeed);
  bench.driving().Hold(CanopenServo::Holder::kEndOfProgram, true);
  bench.Run(seconds(1));
  EXPECT_EQ(bench.driving().Actual().power, PowerState::kSwitchOnDisabled);
  bench.driving().Enable(DriveMode::kSpeed);
  bench.Run(seconds(1));
  EXPECT_NE(bench.driving().Actual().power, PowerState::kOperationEnabled) << "the key was still pressed";
  bench.driving().Hold(CanopenServo::Holder::kEndOfProgram, false);
  bench.Run(seconds(1));
  EXPECT_NE(bench.driving().Actual().power, PowerState::kOperationEnabled) << "letting go started the drive";
}

TEST(DriveBus, LooksAtThePendantItself) {
  InProcessDrives bench;
  bench.Commission();
  bench.BringUp(bench.driving(), DriveMode::kSpeed);
  bench.key_pressed = true;
  // The control loop hangs and orders what it ordered before.
  bench.Run(seconds(1), [&] { bench.driving().CommandSpeed(100.0); });
  EXPECT_EQ(bench.motors[0].reading.speed_inc_per_s, 0.0);
  EXPECT_TRUE(bench.motors[0].command.brake_engaged);
  EXPECT_EQ(bench.driving().report().trouble, DriveTrouble::kQuickStopAsked);
}

TEST(DriveBus, StopsDrivesWhoseControlLoopIsGone) {
  InProcessDrives bench;
  bench.Commission();
  bench.BringUp(bench.driving(), DriveMode::kSpeed);
  bench.Run(milliseconds(500), [&] { bench.driving().CommandSpeed(100.0); });
  bench.Run(seconds(2), [] {});
  EXPECT_EQ(bench.motors[0].reading.speed_inc_per_s, 0.0);
  EXPECT_STREQ(bench.driving().report().words.data(), "the control loop gave no sign of life");
  EXPECT_EQ(bench.driving().Actual().power, PowerState::kFault);
  bench.driving().Enable(DriveMode::kSpeed);
  bench.Run(seconds(1));
  EXPECT_EQ(bench.driving().Actual().power, PowerState::kFault) << "no start without a reset";
  bench.driving().ResetFault();
  bench.Run(milliseconds(200));
  bench.BringUp(bench.driving(), DriveMode::kSpeed);
  EXPECT_EQ(bench.driving().Actual().power, PowerState::kOperationEnabled);
}

// docs/requirements.md R14: the program dies, and the drives stop by themselves.
TEST(DriveBus, LeavesDrivesThatStopByThemselvesWhenTheProgramDies) {
  InProcessDrives bench;
  bench.Commission();
  bench.BringUp(bench.driving(), DriveMode::kSpeed);
  bench.Run(milliseconds(500), [&] { bench.driving().CommandSpeed(100.0); });
  ASSERT_GT(bench.motors[0].reading.speed_inc_per_s, 1e5);
  bench.bench_alive = false;
  bench.Run(milliseconds(600), [] {});
  EXPECT_EQ(bench.motors[0].reading.speed_inc_per_s, 0.0);
  EXPECT_TRUE(bench.motors[0].command.brake_engaged);
}

// docs/requirements.md R15: not only of the drive itself.
TEST(DriveBus, EnablesNoDriveWhileTheSupervisionOfAnyIsOffOrUnknown) {
  InProcessDrives bench;
  bench.Run(milliseconds(100));
  bench.driving().Commission();
  bench.Run(seconds(5));
  ASSERT_EQ(bench.driving().report().stage, DriveStage::kDisabled);
  ASSERT_FALSE(bench.bus->IsSupervised());
  bench.driving().Enable(DriveMode::kSpeed);
  bench.Run(seconds(1));
  EXPECT_NE(bench.driving().Actual().power, PowerState::kOperationEnabled);
  EXPECT_STREQ(
      bench.driving().report().words.data(),
      "not enabled: the supervision of a drive of this bench is off or unknown, so that it would not "
      "notice that this program is gone");
  bench.load().Commission();
  bench.Run(seconds(5));
  EXPECT_TRUE(bench.bus->IsSupervised());
  EXPECT_NE(bench.driving().Actual().power, PowerState::kOperationEnabled) << "it must be asked for anew";
  bench.BringUp(bench.driving(), DriveMode::kSpeed);
  EXPECT_EQ(bench.driving().Actual().power, PowerState::kOperationEnabled);
  EXPECT_STREQ(bench.driving().report().words.data(), "");
}

struct Mishap {
  const char* name;
  void (*happen)(InProcessDrives&);
  DriveTrouble trouble;
};

class DriveBusMishap : public testing::TestWithParam<Mishap> {};

// Whatever happens to one drive while it turns: the bench sees a fault and its reason, the drive stands with
// its brake on, and nothing but a reset or a new set-up brings it back.
TEST_P(DriveBusMishap, StopsTheDriveAndIsNamed) {
  InProcessDrives bench;
  bench.Commission();
  bench.BringUp(bench.driving(), DriveMode::kSpeed);
  const auto loop = [&] {
    bench.driving().CommandSpeed(100.0);
    bench.load().Actual();
  };
  bench.Run(milliseconds(500), loop);
  ASSERT_GT(bench.motors[0].reading.speed_inc_per_s, 1e5);
  GetParam().happen(bench);
  bench.Run(seconds(1), loop);
  EXPECT_EQ(bench.driving().report().trouble, GetParam().trouble) << bench.driving().report().words.data();
  EXPECT_EQ(bench.driving().Actual().power, PowerState::kFault);
  EXPECT_EQ(bench.motors[0].reading.speed_inc_per_s, 0.0);
  EXPECT_TRUE(bench.motors[0].command.brake_engaged);
  bench.driving().Enable(DriveMode::kSpeed);
  bench.Run(seconds(1), loop);
  EXPECT_EQ(bench.motors[0].reading.speed_inc_per_s, 0.0) << "it turned again without a reset";
}

INSTANTIATE_TEST_SUITE_P(
    OfEveryKind, DriveBusMishap,
    testing::Values(
        Mishap{"HeartbeatStops", [](InProcessDrives& b) { b.nodes[0]->faults().heartbeat_stops = true; },
               DriveTrouble::kHeartbeatLost},
        Mishap{"Reboot", [](InProcessDrives& b) { b.nodes[0]->Reboot(); }, DriveTrouble::kNodeRebooted},
        Mishap{"Emergency",
               [](InProcessDrives& b) {
                 b.nodes[0]->RaiseEmergency(0x4310, {1, 2, 3, 4, 5});
               },
               DriveTrouble::kEmergency},
        Mishap{"SafeTorqueOff", [](InProcessDrives& b) { b.motors[0].reading.safe_torque_off = true; },
               DriveTrouble::kEmergency},
        Mishap{"BusOff", [](InProcessDrives& b) { b.buses.SetBusOff(0, true); }, DriveTrouble::kBusOff}),
    [](const auto& instance) { return instance.param.name; });

TEST(DriveBus, RefusesANodeNumberThatIsTaken) {
  TestClock clock;
  InProcessCanBus buses({.ends = 2});
  const auto profile = ReadDriveProfile(InProcessDrives::Profiles() / "strainwave_drive.yaml");
  try {
    const DriveBus bus(buses.end(0), clock, {{"driving servo", profile, 1}, {"load servo", profile, 1}});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "node_id = 1 of the load servo is that of the driving servo (must be its own)");
  }
}

TEST(DriveBus, MeasuresItsSyncsAnewAfterEachLook) {
  InProcessDrives bench;
  bench.Commission();
  (void)bench.bus->TakeSyncIntervals();
  bench.Run(seconds(1));
  bench.clock.now += milliseconds(3);  // one comes late
  bench.Run(milliseconds(4));
  const auto intervals = bench.bus->TakeSyncIntervals();
  EXPECT_EQ(intervals.count, 250U) << "the first cycle only begins anew";
  EXPECT_EQ(intervals.min, milliseconds(4));
  EXPECT_EQ(intervals.max, milliseconds(7));
  bench.Run(milliseconds(40));
  const auto next = bench.bus->TakeSyncIntervals();
  EXPECT_EQ(next.count, 9U);
  EXPECT_EQ(next.max, milliseconds(4));
}

TEST(BusTroubles, SayWhatIsAmissOnABusOnce) {
  InProcessDrives bench;
  bench.Commission();
  EXPECT_TRUE(BusTroubles(bench.bus->counts()).empty());
  bench.nodes[0]->faults().pdo_length_change = -1;
  bench.Run(milliseconds(50));
  const DriveBusCounts malformed = bench.bus->counts();
  const auto troubles = BusTroubles(malformed);
  ASSERT_EQ(troubles.size(), 1U);
  EXPECT_NE(troubles[0].find("not as long as their mapping"), std::string::npos) << troubles[0];

  bench.buses.SetBusOff(0, true);
  bench.Run(milliseconds(50));
  bench.buses.SetBusOff(0, false);
  bench.Run(milliseconds(50));
  const DriveBusCounts off = bench.bus->counts();
  EXPECT_EQ(off.state, CanState::kErrorActive);
  const auto more = BusTroubles(off, malformed);
  ASSERT_EQ(more.size(), 1U) << "it was bus-off for a while; the short PDOs are known";
  EXPECT_EQ(more[0].substr(0, 8), "bus-off:");
  EXPECT_TRUE(BusTroubles(off, off).empty());
}

TEST(BusTroubles, HaveTheirOwnWordsEach) {
  std::set<std::string> all;
  for (const CanState state :
       {CanState::kErrorWarning, CanState::kErrorPassive, CanState::kBusOff, CanState::kGone}) {
    const auto troubles = BusTroubles({.state = state, .worst_state = state});
    ASSERT_EQ(troubles.size(), 1U);
    EXPECT_FALSE(troubles[0].empty());
    all.insert(troubles[0]);
  }
  EXPECT_EQ(all.size(), 4U);
}

}  // namespace
}  // namespace strainwave::bench::drive_bus_test
