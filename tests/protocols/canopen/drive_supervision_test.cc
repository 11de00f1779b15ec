// SPDX-License-Identifier: Apache-2.0
// What goes wrong on the bus and in the drive: each its own alarm, each a stop.
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "tests/protocols/canopen/scripted_drive.h"

namespace strainwave::protocols::canopen::drive_supervision_test {
namespace {

using namespace std::chrono_literals;
using Texts = std::vector<std::string>;
using enum OperationMode;

struct Moving : DriveBench {
  explicit Moving(const DriveProfile& profile = EasyProfile()) : DriveBench(profile) {
    EXPECT_TRUE(BringUp(kProfileVelocity));
    master.CommandSpeed(100.0);
    Cycle();
    Forget();
  }

  /// Keeps what is sent in the cycle of the trouble only.
  void CycleUntilTrouble() {
    for (int i = 0; i < 100 && master.trouble() == DriveTrouble::kNone; ++i) {
      Forget();
      Cycle();
    }
  }

  void ExpectStopFor(DriveTrouble trouble) {
    EXPECT_EQ(master.trouble(), trouble) << master.TroubleWords();
    EXPECT_TRUE(master.TakePurge());
    Deliver();
    EXPECT_NE(master.Enable(kProfileVelocity, now), DriveAnswer::kAccepted);
    EXPECT_EQ(master.CommandSpeed(1.0), DriveAnswer::kNotEnabledInMode);
    for (const std::string& payload : SentTo("303")) EXPECT_EQ(payload.substr(8), "00000000");
  }
};

// Point 9, one test each.
TEST(DriveSupervision, StopsWhenTheHeartbeatIsLost) {
  Moving bench;
  bench.sends_heartbeats = false;
  bench.CycleUntilTrouble();
  bench.ExpectStopFor(DriveTrouble::kHeartbeatLost);
  EXPECT_EQ(bench.drive.power, PowerState::kQuickStopActive);
  EXPECT_EQ(bench.master.ResetFault(bench.now), DriveAnswer::kCommissionFirst);
}

TEST(DriveSupervision, StopsWhenTheNodeStartsAnewAndSendsItNoProcessData) {
  Moving bench;
  bench.Hear("703#00");
  bench.ExpectStopFor(DriveTrouble::kNodeRebooted);
  EXPECT_EQ(bench.master.stage(), DriveStage::kOff);
  bench.sends_pdos = false;
  for (int i = 0; i < 100; ++i) bench.Cycle();
  EXPECT_EQ(bench.sent, Texts{});
  // Somebody else has started it: it is taken out of operation again, and is sent nothing else.
  bench.sends_pdos = true;
  for (int i = 0; i < 100; ++i) bench.Cycle();
  EXPECT_EQ(std::set<std::string>(bench.sent.begin(), bench.sent.end()), std::set<std::string>{"000#8003"});
  EXPECT_EQ(bench.master.ResetFault(bench.now), DriveAnswer::kCommissionFirst);
  // Set up anew it may be enabled again.
  bench.drive.power = PowerState::kSwitchOnDisabled;
  EXPECT_TRUE(bench.BringUp(kProfileVelocity)) << bench.master.TroubleWords();
}

TEST(DriveSupervision, StopsWhenTheNmtStateChanges) {
  for (const char* heartbeat : {"703#7F", "703#04", "703#84"}) {
    Moving bench;
    bench.Hear(heartbeat);
    bench.ExpectStopFor(DriveTrouble::kNmtStateChanged);
  }
  Moving bench;
  bench.Hear("703#7F");
  EXPECT_EQ(bench.master.TroubleWords(),
            "node 3: the drive left the operational state by itself: it may miss the master's heartbeat "
            "(pre-operational)");
}

// Point 10.
TEST(DriveSupervision, TakesAHeartbeatsToggleBitForNothing) {
  Moving bench;
  bench.Hear("703#85");
  bench.Hear("703#05");
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kNone);
}

TEST(DriveSupervision, StopsOnAnEmergencyAndKeepsTheMakersBytes) {
  for (const char* frame : {"083#3081000000000000", "083#4081000000000000", "083#1082000000000000",
                            "083#5082110A0B0C0D0E", "083#1086210102030405"}) {
    Moving bench;
    bench.Hear(frame);
    bench.ExpectStopFor(DriveTrouble::kEmergency);
  }
  Moving bench;
  bench.Hear("083#5082110A0B0C0D0E");
  EXPECT_EQ(bench.master.TroubleWords(),
            "the drive sent an emergency message: node 3 reports 8250h: PDO not received in time "
            "(error register 11h, maker's bytes 0A 0B 0C 0D 0E)");
}

TEST(DriveSupervision, StopsForNoEmergencyOfAnotherNodeNorForOneTakenBackNorForAWarning) {
  DriveProfile profile = EasyProfile();
  profile.quirks.warning_codes = {0x4210};
  Moving bench(profile);
  for (const char* frame : {"084#3081000000000000", "083#0000000000000000", "083#1042000000000000"}) {
    bench.Hear(frame);
    EXPECT_EQ(bench.master.trouble(), DriveTrouble::kNone) << frame;
  }
  EXPECT_EQ(bench.master.emergency()->code, 0x4210);
}

TEST(DriveSupervision, NamesWhatComesAfterAStopThatWasAskedFor) {
  Moving bench;
  bench.master.QuickStop(bench.now);
  ASSERT_TRUE(bench.CycleUntil(DriveStage::kStopped));
  bench.Hear("083#1043090000000000");
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kEmergency);
  // That the bench then stops once more does not take it away.
  bench.master.QuickStop(bench.now);
  EXPECT_EQ(bench.master.last_trouble(), DriveTrouble::kEmergency);
  EXPECT_NE(bench.master.TroubleWords().find("4310h"), std::string::npos) << bench.master.TroubleWords();
}

TEST(DriveSupervision, KeepsTheFirstReasonAndTellsTheLast) {
  Moving bench;
  bench.Hear("083#1086210102030405");
  bench.drive.power = PowerState::kFault;
  bench.Cycle();
  bench.Hear("703#7F");
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kEmergency);
  EXPECT_EQ(bench.master.last_trouble(), DriveTrouble::kNmtStateChanged);
  // What came later counts for the way back all the same.
  bench.CycleUntil(DriveStage::kStopped);
  EXPECT_EQ(bench.master.ResetFault(bench.now), DriveAnswer::kCommissionFirst);
}

TEST(DriveSupervision, StopsOnAStatuswordThatFitsNoState) {
  Moving bench;
  bench.Hear("183#6702030000");
  bench.ExpectStopFor(DriveTrouble::kStatusUnclear);
}

// Point 11.
TEST(DriveSupervision, SendsNothingAfterBusOffUntilTheOperatorSetsUpAnew) {
  Moving bench;
  bench.now += 4ms;
  bench.master.OnSync(bench.now);  // set-points are queued
  CanFrame error{.id = 0x40, .error = true, .length = 8};
  bench.Hear(error);
  bench.ExpectStopFor(DriveTrouble::kBusOff);
  for (int i = 0; i < 1000; ++i) bench.Cycle();  // the bus may have come back
  EXPECT_EQ(bench.sent, Texts{});
  EXPECT_EQ(bench.master.ResetFault(bench.now), DriveAnswer::kCommissionFirst);
  EXPECT_EQ(bench.master.Enable(kProfileVelocity, bench.now), DriveAnswer::kCommissionFirst);
  bench.drive.power = PowerState::kSwitchOnDisabled;
  EXPECT_TRUE(bench.BringUp());
}

TEST(DriveSupervision, TakesOtherErrorFramesForNoBusOff) {
  Moving bench;
  bench.Hear(CanFrame{.id = 0x04, .error = true, .length = 8});
  // An error frame whose bits look like a boot-up is none.
  bench.Hear(CanFrame{.id = 0x703, .error = true, .length = 1});
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kNone);
}

TEST(DriveSupervision, StopsWhenTheTransmitQueueIsFull) {
  Moving bench;
  bench.now += 4ms;
  bench.master.OnSync(bench.now);
  bench.master.OnTransmitFull(bench.now);
  bench.ExpectStopFor(DriveTrouble::kTransmitQueueFull);
  EXPECT_EQ(bench.SentTo("203"), Texts{"020003"});
}

TEST(DriveSupervision, StopsWhenNobodyTakesItsFrames) {
  Moving bench;
  for (int i = 0; i < 30 && bench.master.trouble() == DriveTrouble::kNone; ++i) {
    bench.now += 4ms;
    bench.Hear(bench.drive.Status());
    bench.Hear(bench.drive.Motion());
    bench.Hear(bench.drive.Torque());
    bench.master.OnSync(bench.now);
  }
  bench.ExpectStopFor(DriveTrouble::kTransmitQueueFull);
}

TEST(DriveSupervision, MarksStaleWhatIsOlderThanTheStatedNumberOfSyncs) {
  Moving bench;
  bench.sends_pdos = false;
  for (int i = 0; i < 4; ++i) bench.Cycle();
  EXPECT_FALSE(bench.master.status().is_stale);
  bench.Forget();
  bench.Cycle();
  EXPECT_TRUE(bench.master.status().is_stale);
  bench.ExpectStopFor(DriveTrouble::kPdoMissing);
}

TEST(DriveSupervision, MissesASinglePdoByItsName) {
  Moving bench;
  bench.sends_pdos = false;
  for (int i = 0; i < 20; ++i) {
    bench.Hear(bench.drive.Status());
    bench.Hear(bench.drive.Torque());
    bench.Cycle();
  }
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kPdoMissing);
  EXPECT_EQ(bench.master.TroubleWords(), "node 3: the drive's process data no longer come in (PDO 283h)");
}

TEST(DriveSupervision, TakesNoPdoOfAnotherLength) {
  Moving bench;
  bench.sends_pdos = false;
  for (int i = 0; i < 20 && bench.master.trouble() == DriveTrouble::kNone; ++i) {
    bench.Hear("183#37020300");        // short
    bench.Hear("283#00000000000000");  // short
    bench.Hear("383#000000");          // long
    bench.Cycle();
  }
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kPdoMissing);
  EXPECT_GT(bench.master.malformed_frames(), 10U);
}

// Point 8.
TEST(DriveSupervision, MeasuresSyncJitterAndStopsAboveTheStatedOne) {
  DriveProfile profile = EasyProfile();
  profile.timing.most_sync_deviation = 1ms;
  Moving bench(profile);
  (void)bench.master.TakeSyncIntervals();
  bench.Cycle(3500us);
  bench.Cycle(4900us);
  const SyncIntervals intervals = bench.master.TakeSyncIntervals();
  EXPECT_EQ(intervals.count, 2U);
  EXPECT_EQ(intervals.min, 3500us);
  EXPECT_EQ(intervals.max, 4900us);
  EXPECT_EQ(intervals.mean, 4200us);
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kNone);
  bench.Forget();
  bench.Cycle(5100us);
  EXPECT_EQ(
      bench.master.TroubleWords(),
      "node 3: SYNC came too early or too late: the control computer is overloaded (after 5100 µs instead "
      "of 4000 µs)");
  bench.ExpectStopFor(DriveTrouble::kSyncJitter);
}

// Point 8, the other half: the drive notices that RPDOs are missing.
TEST(DriveSupervision, ArmsTheEventTimerOfTheControlwordsPdo) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp());
  EXPECT_EQ((bench.drive.objects[{0x1400, 5}]), 50U);
}

TEST(DriveSupervision, AbandonsTheSetUpOfANodeThatStartsAnew) {
  DriveBench bench;
  bench.master.Commission(bench.now);
  bench.Hear("703#00");
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kNodeRebooted);
  EXPECT_EQ(bench.master.stage(), DriveStage::kOff);
  for (int i = 0; i < 50; ++i) bench.Cycle();
  EXPECT_EQ(bench.sent, Texts{});
}

// docs/requirements.md R14.
TEST(DriveSupervision, SaysNothingMoreAfterGoingSilentWhateverHappens) {
  Moving bench;
  bench.master.GoSilent();
  bench.Hear("083#3081000000000000");
  bench.Hear("703#7F");
  bench.drive.power = PowerState::kQuickStopActive;
  for (int i = 0; i < 100; ++i) bench.Cycle();
  EXPECT_EQ(bench.sent, Texts{});
  EXPECT_EQ(bench.master.status().power, PowerState::kQuickStopActive);  // but it listens
  EXPECT_EQ(bench.master.Enable(kProfileVelocity, bench.now), DriveAnswer::kCommissionFirst);
  bench.drive.power = PowerState::kSwitchOnDisabled;
  EXPECT_TRUE(bench.BringUp());
}

TEST(DriveSupervision, BreaksItsSilenceForAQuickStop) {
  Moving bench;
  bench.master.GoSilent();
  for (int i = 0; i < 5; ++i) bench.Cycle();
  EXPECT_EQ(bench.sent, Texts{});
  bench.master.QuickStop(bench.now);
  bench.Deliver();
  EXPECT_EQ(bench.SentTo("203"), Texts{"020003"});
  ASSERT_TRUE(bench.CycleUntil(DriveStage::kStopped));
  EXPECT_EQ(bench.master.ResetFault(bench.now), DriveAnswer::kCommissionFirst);
}

TEST(DriveTrouble, HasItsOwnWordsEach) {
  std::set<std::string_view> words;
  for (int i = 0; i < kDriveTroubles; ++i) words.insert(Words(static_cast<DriveTrouble>(i)));
  EXPECT_EQ(words.size(), static_cast<std::size_t>(kDriveTroubles));
  EXPECT_FALSE(words.contains("not a trouble"));
}

// Hostile traffic: no frame may break the master, and none may make it move a drive.
TEST(DriveSupervision, SurvivesAnyFrameAndMovesNothingForIt) {
  std::mt19937 random(20);
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp());
  bench.Forget();
  const auto byte = [&] { return static_cast<std::uint8_t>(random()); };
  for (int i = 0; i < 200000; ++i) {
    CanFrame frame;
    const auto any = random();
    frame.id = static_cast<std::uint32_t>(random() % 4 == 0 ? any : any % 16 * 0x80 + random() % 5);
    frame.extended = random() % 16 == 0;
    frame.remote = random() % 16 == 0;
    frame.error = random() % 64 == 0;
    frame.length = random() % 8 == 0 ? byte() : static_cast<std::uint8_t>(random() % 9);
    for (std::uint8_t& data : frame.data) data = byte();
    bench.master.OnFrame(frame, bench.now);
    if (i % 8 == 0) {
      bench.now += 4ms;
      bench.master.OnSync(bench.now);
      bench.master.Poll(bench.now);
      bench.Deliver();
    }
    if (i % 500 == 0) {
      bench.drive.is_operational = true;
      bench.master.Commission(bench.now);
      bench.master.ResetFault(bench.now);
    }
  }
  for (const std::string& text : bench.sent) {
    EXPECT_FALSE(text.starts_with("203#0F")) << text;
  }
}

}  // namespace
}  // namespace strainwave::protocols::canopen::drive_supervision_test
