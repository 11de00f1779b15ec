// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/commissioning.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "tests/protocols/canopen/scripted_drive.h"

namespace strainwave::protocols::canopen::commissioning_test {
namespace {

using Action = CommissioningStep::Action;
using Concern = CommissioningStep::Concern;
using State = Commissioning::State;
using namespace std::chrono_literals;

struct Boot {
  explicit Boot(const DriveProfile& profile = EasyProfile())
      : commissioning(CommissioningSteps(profile, 3), 3, 100ms) {}

  State Run() {
    std::chrono::nanoseconds now = 1s;
    commissioning.Start(now);
    for (int i = 0; i < 1000 && commissioning.state() == State::kRunning; ++i) {
      now += 10ms;
      while (const auto frame = commissioning.Poll(now)) {
        sent.push_back(Text(*frame));
        drive.OnFrame(*frame);
      }
      while (!drive.answers.empty()) {
        commissioning.OnFrame(drive.answers.front(), now);
        drive.answers.pop_front();
      }
    }
    return commissioning.state();
  }

  ScriptedDrive drive;
  Commissioning commissioning;
  std::vector<std::string> sent;
};

TEST(Commissioning, TakesEveryStepOfAWillingDrive) {
  Boot boot;
  EXPECT_EQ(boot.Run(), State::kDone) << boot.commissioning.FailureWords();
  EXPECT_EQ(boot.commissioning.steps_done(), boot.commissioning.steps().size());
  EXPECT_EQ(boot.commissioning.FailureWords(), "");
}

// Point 1.
TEST(Commissioning, ChecksTheIdentityBeforeAnythingElse) {
  Boot boot;
  boot.Run();
  ASSERT_GT(boot.sent.size(), 4U);
  EXPECT_EQ(boot.sent[0], "603#4000100000000000");
  EXPECT_EQ(boot.sent[1], "603#4018100100000000");
  EXPECT_EQ(boot.sent[2], "603#4018100200000000");
  EXPECT_EQ(boot.sent[3], "603#4002650000000000");  // revision 0 takes any
}

TEST(Commissioning, StopsADriveThatWasLeftMovingBeforeItsSettingsChange) {
  Boot boot;
  boot.Run();
  EXPECT_EQ(boot.drive.written.at(0), kControlwordObject);
  EXPECT_EQ(boot.drive.objects[kControlwordObject], 0x0002U);
}

TEST(Commissioning, RefusesAWrongDriveInWordsAndWritesNothingToIt) {
  Boot boot;
  boot.drive.objects[{0x1018, 1}] = 0x9A;
  EXPECT_EQ(boot.Run(), State::kFailed);
  EXPECT_TRUE(boot.drive.written.empty());
  EXPECT_EQ(boot.commissioning.FailureWords(),
            "node 3 is another drive than the profile's, nothing was written to it: vendor (1018h:01) is "
            "0000009Ah (expected 0000029Ch)");
}

TEST(Commissioning, RefusesADeviceThatIsNoDrive) {
  Boot boot;
  boot.drive.objects[{0x1000, 0}] = 0x00030191;  // an input/output module
  EXPECT_EQ(boot.Run(), State::kFailed);
  EXPECT_TRUE(boot.drive.written.empty());
  EXPECT_EQ(
      boot.commissioning.FailureWords(),
      "node 3 is another drive than the profile's, nothing was written to it: device profile (1000h:00) "
      "is 00000191h (expected 00000192h)");
}

TEST(Commissioning, RefusesADriveWithoutAModeOfTheProfile) {
  Boot boot;
  boot.drive.objects[{0x6502, 0}] = 0x1;
  EXPECT_EQ(boot.Run(), State::kFailed);
  EXPECT_EQ(
      boot.commissioning.FailureWords(),
      "node 3 is not able to do what the profile says: supported modes (6502h:00) is 00000001h (expected "
      "000003ADh)");
}

TEST(Commissioning, RefusesADriveWhoseEmergenciesWouldNotBeHeard) {
  const auto words = [](std::uint32_t cob_id) {
    Boot boot;
    boot.drive.objects[{0x1014, 0}] = cob_id;
    EXPECT_EQ(boot.Run(), State::kFailed);
    return boot.commissioning.FailureWords();
  };
  EXPECT_EQ(words(0x123),
            "node 3 says its emergencies where nobody listens: COB-ID of emergency messages (1014h:00) is "
            "00000123h (expected 00000083h); let the profile's objects set it");
  // Its own id, but switched off.
  EXPECT_NE(words(0x80000083).find("is 80000083h (expected 00000083h)"), std::string::npos);
}

TEST(Commissioning, LetsTheProfilePutTheEmergenciesWhereTheyAreHeard) {
  DriveProfile profile = EasyProfile();
  ProfileObject object;
  object.address = {0x1014, 0};
  object.type = DataType::kUnsigned32;
  object.value = 0x83;
  profile.objects = {object};
  Boot boot(profile);
  boot.drive.objects[{0x1014, 0}] = 0x123;
  EXPECT_EQ(boot.Run(), State::kDone) << boot.commissioning.FailureWords();
  profile.quirks.absent_objects = {0x1014};
  Boot without(profile);
  without.drive.objects[{0x1014, 0}] = 0x123;
  EXPECT_EQ(without.Run(), State::kDone) << without.commissioning.FailureWords();
}

TEST(Commissioning, RefusesAMotorOfAnotherRatedTorque) {
  Boot boot;
  boot.drive.objects[{0x6076, 0}] = 1270;
  EXPECT_EQ(boot.Run(), State::kFailed);
  EXPECT_TRUE(boot.drive.written.empty());
  EXPECT_EQ(boot.commissioning.FailureWords(),
            "node 3: rated torque (6076h:00) is 1270, the profile has 1000 mNm (expected rated_torque as on "
            "the motor's data "
            "sheet, and rated_torque_unit where the drive does not count in mNm)");
}

// One of a public file of a maker: 512871 for a motor of 0.513 Nm.
TEST(Commissioning, SaysInWhichUnitADriveHoldsItsRatedTorque) {
  DriveProfile profile = EasyProfile();
  profile.units.rated_torque_Nm = 0.513;
  Boot boot(profile);
  boot.drive.objects[{0x6076, 0}] = 512871;
  EXPECT_EQ(boot.Run(), State::kFailed);
  EXPECT_EQ(boot.commissioning.FailureWords(),
            "node 3: rated torque (6076h:00) is 512871, the profile has 513 mNm: they differ by just 1000; "
            "if the drive "
            "counts in uNm, the profile says so: units: {rated_torque_unit: uNm}");
  profile.units.rated_torque_Nm = 0.512871;
  profile.units.rated_torque_units_per_Nm = 1e6;
  Boot named(profile);
  named.drive.objects[{0x6076, 0}] = 512871;
  EXPECT_EQ(named.Run(), State::kDone) << named.commissioning.FailureWords();
}

// Point 2.
TEST(Commissioning, WritesEveryProtectiveObjectAndReadsItBackRightAfter) {
  const ObjectAddress protective[] = {
      {0x1016, 1}, {0x1017, 0}, {0x1029, 1}, {0x6007, 0}, {0x605A, 0}, {0x605B, 0}, {0x605C, 0}, {0x605D, 0},
      {0x605E, 0}, {0x6085, 0}, {0x6065, 0}, {0x6066, 0}, {0x6072, 0}, {0x607F, 0}, {0x60C2, 1}, {0x60C2, 2}};
  const std::vector<CommissioningStep> steps = CommissioningSteps(EasyProfile(), 3);
  for (const ObjectAddress& address : protective) {
    const auto write = std::find_if(steps.begin(), steps.end(), [&](const CommissioningStep& step) {
      return step.address == address && step.action == Action::kWrite;
    });
    ASSERT_NE(write, steps.end()) << Words(address);
    const auto read = write + 1;
    EXPECT_EQ(read->address, address);
    EXPECT_EQ(read->action, Action::kExpect);
    EXPECT_EQ(read->value, write->value);
  }
}

TEST(Commissioning, RefusesADriveThatDoesNotKeepWhatWasWritten) {
  for (const ObjectAddress address : {ObjectAddress{0x1016, 1},
                                      {0x1017, 0},
                                      {0x6007, 0},
                                      {0x605A, 0},
                                      {0x6085, 0},
                                      {0x6065, 0},
                                      {0x6072, 0},
                                      {0x607F, 0}}) {
    Boot boot;
    boot.drive.ignores_writes.insert(address);
    EXPECT_EQ(boot.Run(), State::kFailed) << Words(address);
    EXPECT_NE(boot.commissioning.FailureWords().find(Words(address)), std::string::npos);
  }
  Boot boot;
  boot.drive.ignores_writes.insert({0x605A, 0});
  boot.Run();
  EXPECT_EQ(boot.commissioning.FailureWords(),
            "node 3 did not take a setting: quick stop option code (605Ah:00) reads 0000h (written 0002h)");
}

TEST(Commissioning, WritesTheNumbersOfTheProfileInTheDrivesUnits) {
  Boot boot;
  ASSERT_EQ(boot.Run(), State::kDone);
  const auto read = [&](std::uint16_t index, std::uint8_t subindex) {
    return boot.drive.objects[{index, subindex}];
  };
  EXPECT_EQ(read(0x1016, 1), 0x007F0096U);  // node 127, 150 ms
  EXPECT_EQ(read(0x1017, 0), 50U);
  EXPECT_EQ(read(0x6007, 0), 3U);
  EXPECT_EQ(read(0x607F, 0), 3000U);  // 314.16 rad/s in rpm
  EXPECT_EQ(read(0x6081, 0), 3000U);
  EXPECT_EQ(read(0x6072, 0), 2000U);   // twice the rated torque
  EXPECT_EQ(read(0x6085, 0), 47746U);  // 5000 rad/s² in rpm/s
  EXPECT_EQ(read(0x6065, 0), 326U);    // 0.5 rad of 4096 counts a turn
  EXPECT_EQ(read(0x60C2, 1), 4U);
  EXPECT_EQ(read(0x60C2, 2), 0xFDU);  // 4 · 10⁻³ s
}

TEST(Commissioning, WritesTheInterpolationPeriodExactly) {
  const auto pair = [](std::chrono::nanoseconds period) {
    DriveProfile profile = EasyProfile();
    profile.timing.sync_period = period;
    Boot boot(profile);
    boot.Run();
    return std::pair(boot.drive.objects[{0x60C2, 1}],
                     static_cast<int>(static_cast<std::int8_t>(boot.drive.objects[{0x60C2, 2}])));
  };
  EXPECT_EQ(pair(1ms), std::pair(1U, -3));
  EXPECT_EQ(pair(10ms), std::pair(10U, -3));
  EXPECT_EQ(pair(20ms), std::pair(20U, -3));
  EXPECT_EQ(pair(500us), std::pair(5U, -4));
  EXPECT_EQ(pair(250us), std::pair(25U, -5));
}

// Point 3, on the wire.
TEST(Commissioning, MapsAPdoAnewInOrderAndKeepsBit30) {
  Boot boot;
  boot.drive.objects[{0x1801, 1}] = 0x40000283;
  ASSERT_EQ(boot.Run(), State::kDone);
  std::vector<std::string> writes;
  for (const std::string& text : boot.sent) {
    const bool is_of_pdo = text.substr(6, 4) == "0118" || text.substr(6, 4) == "011A";
    if (is_of_pdo && text.substr(4, 2) != "40") writes.push_back(text.substr(4));
  }
  EXPECT_EQ(writes, (std::vector<std::string>{
                        "23011801830200C0",  // bit 31 set, bit 30 kept
                        "2F011A0000000000", "23011A0120006460", "23011A0220006C60", "2F011A0002000000",
                        "2F01180201000000",
                        "2301180183020040",  // bit 31 clear, bit 30 kept
                    }));
}

TEST(Commissioning, RefusesAPdoThatReadsBackOtherwise) {
  Boot boot;
  boot.drive.ignores_writes.insert({0x1A01, 2});
  EXPECT_EQ(boot.Run(), State::kFailed);
  EXPECT_EQ(boot.commissioning.FailureWords(),
            "node 3 did not take a setting: TPDO 2 (1A01h:02) reads 00000000h (written 606C0020h)");
}

// docs/requirements.md R15.
TEST(Commissioning, ReadsEverySupervisionAtTheEndAndRefusesOneThatIsOff) {
  const std::vector<CommissioningStep> steps = CommissioningSteps(EasyProfile(), 3);
  std::vector<std::string> last;
  for (const CommissioningStep& step : steps) {
    if (step.concern == Concern::kSupervision) last.push_back(Words(step.address));
  }
  EXPECT_EQ(last, (std::vector<std::string>{"1017h:00", "1016h:01", "1029h:01", "6007h:00", "1400h:05"}));
  EXPECT_EQ(steps.back().concern, Concern::kSupervision);
}

TEST(Commissioning, SaysInWordsThatASupervisionReadsBackAsOff) {
  DriveProfile profile = EasyProfile();
  profile.option_codes.abort_connection = 0;  // a profile that asks for it is no excuse
  Boot boot(profile);
  EXPECT_EQ(boot.Run(), State::kFailed);
  EXPECT_EQ(
      boot.commissioning.FailureWords(),
      "node 3 must not be enabled, it would not notice that the master is gone: abort connection option "
      "code (6007h:00) reads back as off (0000h)");

  profile = EasyProfile();
  profile.supervision.communication_error_behaviour = 1;
  Boot other(profile);
  EXPECT_EQ(other.Run(), State::kFailed);
  EXPECT_NE(other.commissioning.FailureWords().find("(1029h:01) reads back as off (01h)"), std::string::npos);

  profile = EasyProfile();
  profile.supervision.master_timeout_ms = 0;
  Boot third(profile);
  EXPECT_EQ(third.Run(), State::kFailed);
  EXPECT_NE(third.commissioning.FailureWords().find("(1016h:01) reads back as off (007F0000h)"),
            std::string::npos);
}

TEST(Commissioning, TakesAPositionWithoutEnds) {
  constexpr std::pair<std::uint32_t, std::uint32_t> kNone[] = {
      {0, 0}, {0x80000000, 0x7FFFFFFF}, {0x80000001, 0x7FFFFFFF}};
  for (const auto& [lower, upper] : kNone) {
    Boot boot;
    for (const std::uint16_t index : {std::uint16_t{0x607B}, std::uint16_t{0x607D}}) {
      boot.drive.objects[{index, 1}] = lower;
      boot.drive.objects[{index, 2}] = upper;
    }
    EXPECT_EQ(boot.Run(), State::kDone) << boot.commissioning.FailureWords();
  }
  Boot boot;
  boot.drive.unknown = {{0x607B, 1}, {0x607B, 2}, {0x607D, 1}, {0x607D, 2}};
  EXPECT_EQ(boot.Run(), State::kDone) << boot.commissioning.FailureWords();
}

TEST(Commissioning, RefusesAPositionThatEndsBeforeItsThirtyTwoBits) {
  for (const ObjectAddress address : {ObjectAddress{0x607B, 1}, {0x607B, 2}, {0x607D, 1}, {0x607D, 2}}) {
    Boot boot;
    boot.drive.objects[address] = 0x00FFFFFF;
    EXPECT_EQ(boot.Run(), State::kFailed) << Words(address);
  }
  Boot boot;
  boot.drive.objects[{0x607B, 2}] = 3599;
  boot.Run();
  EXPECT_EQ(
      boot.commissioning.FailureWords(),
      "node 3 counts its position between ends, and a campaign turns the shaft on for weeks: upper end of "
      "the position range (607Bh:02) is 00000E0Fh (expected 00000000h: none); let the profile's objects "
      "set it");
}

TEST(Commissioning, LeavesTheProfileItsSoftLimits) {
  DriveProfile profile = EasyProfile();
  using Do = ProfileObject::Action;
  profile.objects = {{{0x607D, 1}, DataType::kInteger32, -9000, Do::kWriteAndReadBack, "lower soft limit"},
                     {{0x607D, 2}, DataType::kInteger32, 9000, Do::kWriteAndReadBack, "upper soft limit"}};
  Boot boot(profile);
  EXPECT_EQ(boot.Run(), State::kDone) << boot.commissioning.FailureWords();
}

TEST(Commissioning, LeavesOutWhatTheDriveLacks) {
  DriveProfile profile = EasyProfile();
  profile.quirks.absent_objects = {0x6007, 0x6076};
  Boot boot(profile);
  boot.drive.unknown = {{0x6007, 0}, {0x6076, 0}};
  EXPECT_EQ(boot.Run(), State::kDone) << boot.commissioning.FailureWords();
}

TEST(Commissioning, GivesTheDrivesAbortInWords) {
  Boot boot;
  boot.drive.unknown.insert({0x605E, 0});
  EXPECT_EQ(boot.Run(), State::kFailed);
  EXPECT_EQ(boot.commissioning.FailureWords(),
            "fault reaction option code cannot be written: node 3, 605Eh:00: there is no such object "
            "(06020000h from the node)");
}

TEST(Commissioning, GivesUpOnASilentDrive) {
  Boot boot;
  boot.drive.is_dead = true;
  EXPECT_EQ(boot.Run(), State::kFailed);
  EXPECT_EQ(
      boot.commissioning.FailureWords(),
      "device profile cannot be read: node 3, 1000h:00: the answer did not come in time (05040000h from "
      "this side)");
}

TEST(Commissioning, WritesAndChecksTheProfilesOwnObjects) {
  DriveProfile profile = EasyProfile();
  using Do = ProfileObject::Action;
  profile.objects = {{{0x6098, 0}, DataType::kInteger32, -3, Do::kWriteAndReadBack, "homing method"},
                     {{0x2100, 1}, DataType::kUnsigned32, 7, Do::kWrite, "maker's filter"},
                     {{0x608F, 1}, DataType::kUnsigned32, 4096, Do::kExpect, "encoder increments"}};
  Boot boot(profile);
  boot.drive.ignores_writes.insert({0x2100, 1});
  boot.drive.objects[{0x608F, 1}] = 4096;
  EXPECT_EQ(boot.Run(), State::kDone) << boot.commissioning.FailureWords();
  EXPECT_EQ((boot.drive.objects[{0x6098, 0}]), 0xFFFFFFFDU);

  boot.drive.objects[{0x608F, 1}] = 8192;
  EXPECT_EQ(boot.Run(), State::kFailed);
  EXPECT_EQ(boot.commissioning.FailureWords(),
            "node 3 is not able to do what the profile says: encoder increments (608Fh:01) is 00002000h "
            "(expected 00001000h)");
}

}  // namespace
}  // namespace strainwave::protocols::canopen::commissioning_test
