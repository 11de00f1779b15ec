// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "protocols/canopen/drive_profile.h"
#include "tests/protocols/canopen/scripted_drive.h"

namespace strainwave::protocols::canopen::profile_check_test {
namespace {

using Findings = std::vector<std::string>;

template <typename Change>
Findings CheckWith(Change change) {
  DriveProfile profile = EasyProfile();
  change(profile);
  return CheckProfile(profile);
}

TEST(CheckProfile, FindsNothingInASoundProfile) { EXPECT_EQ(CheckProfile(EasyProfile()), Findings{}); }

TEST(CheckProfile, FindsEveryNumberThatCannotBe) {
  EXPECT_EQ(CheckWith([](DriveProfile& p) {
              p.units.position_counts_per_rev = 0.0;
              p.units.sign = 0;
              p.limits.max_torque_Nm = -1.0;
            }),
            (Findings{"position_counts_per_rev = 0 is not above zero", "sign = 0 is neither 1 nor -1",
                      "max_torque_Nm = -1 is not above zero"}));
}

TEST(CheckProfile, FindsSupervisionThatIsSwitchedOff) {
  EXPECT_EQ(CheckWith([](DriveProfile& p) {
              p.supervision.master_heartbeat_ms = 0;
              p.supervision.drive_timeout_ms = 50;
              p.supervision.rpdo_event_timer_ms = 0;
            }),
            (Findings{"master_heartbeat_ms = 0 switches the master's heartbeat off",
                      "drive_timeout_ms is not above drive_heartbeat_ms",
                      "rpdo_event_timer_ms = 0 lets missing set-points go unnoticed"}));
  EXPECT_EQ(
      CheckWith([](DriveProfile& p) {
        p.option_codes.abort_connection = 0;
        p.supervision.communication_error_behaviour = 1;
      }),
      (Findings{"neither abort_connection (6007h) nor communication_error_behaviour (1029h:01) stops the "
                "drive when the master is gone"}));
  EXPECT_EQ(CheckWith([](DriveProfile& p) { p.quirks.absent_objects = {0x1016}; }),
            (Findings{"a drive without heartbeats (1016h, 1017h) cannot be watched"}));
}

TEST(CheckProfile, FindsAModeWithoutItsSetPointAndOneThatIsNotOfThisMaster) {
  EXPECT_EQ(CheckWith([](DriveProfile& p) {
              p.modes = {OperationMode::kCyclicTorque, OperationMode::kVelocity};
              p.pdos = StandardPdos(p);
              p.pdos[2].entries = {{kDigitalOutputsObject, 32}};
            }),
            (Findings{"no PDO maps 6071h:00 (cyclic synchronous torque)",
                      "modes: velocity is not a mode of this master"}));
}

TEST(CheckProfile, FindsPdosThatCannotBe) {
  EXPECT_EQ(CheckWith([](DriveProfile& p) {
              p.pdos = StandardPdos(p);
              p.pdos[0].entries[1].bits = 16;
              p.pdos[1].entries.push_back({{0x2345, 6}, 32});
              p.pdos[4].cob_id = 0x180;
            }),
            (Findings{"PDO 200h maps 6060h:00 with 16 bits, it has 8", "PDO 301h maps 96 bits, above 64",
                      "PDO 300h maps 2345h:06, for which the master has no value",
                      "two PDOs share the COB-ID 180h"}));
}

TEST(CheckProfile, FindsMorePdosThanADriveMayHave) {
  EXPECT_EQ(CheckWith([](DriveProfile& p) {
              p.pdos = StandardPdos(p);
              for (std::uint16_t i = 0; i < 11; ++i) {
                p.pdos.push_back({PdoFlow::kFromDrive,
                                  static_cast<std::uint16_t>(10 + i),
                                  0x490U + i,
                                  1,
                                  {},
                                  {},
                                  {{kErrorCodeObject, 16}}});
              }
            }),
            (Findings{"pdos = 17 are more than 16"}));
}

TEST(CheckProfile, FindsAPdoThatMayComeLaterThanIsBorne) {
  EXPECT_EQ(CheckWith([](DriveProfile& p) {
              p.pdos = StandardPdos(p);
              p.pdos[3].event_timer_ms = 20;
            }),
            (Findings{"PDO 180h may come later than stale_after_syncs = 5 bears"}));
}

TEST(CheckProfile, FindsABrakeBitThatIsTheStandards) {
  EXPECT_EQ(
      CheckWith([](DriveProfile& p) { p.brake = {.by = BrakeControl::By::kControlword, .mask = 0x0100}; }),
      (Findings{"brake mask 100h is not of bits 11 to 15 of the controlword"}));
  EXPECT_EQ(CheckWith([](DriveProfile& p) { p.brake.mask = 0; }),
            (Findings{"brake mask 0 names no digital output"}));
}

TEST(CheckProfile, FindsAnObjectThatDoesNotFit) {
  EXPECT_EQ(CheckWith([](DriveProfile& p) {
              p.objects = {{{0x2000, 1}, DataType::kInteger8, 128, {}, "a"},
                           {{0x2000, 2}, DataType::kUnsigned16, -1, {}, "b"},
                           {{0x2000, 3}, DataType::kVisibleString, 0, {}, "c"},
                           {{0x2000, 4}, DataType::kInteger8, -128, {}, "d"}};
            }),
            (Findings{"2000h:01: 128 does not fit into 8 bits", "2000h:02: -1 does not fit into 16 bits",
                      "2000h:03: only integers of at most 32 bits can be written"}));
}

TEST(StandardPdos, AddTheNodeToEveryIdentifier) {
  const std::vector<PdoSetting> pdos = PdosOf(EasyProfile(), 5);
  std::vector<std::uint32_t> cob_ids;
  for (const PdoSetting& pdo : pdos) cob_ids.push_back(pdo.cob_id);
  EXPECT_EQ(cob_ids, (std::vector<std::uint32_t>{0x205, 0x305, 0x405, 0x185, 0x285, 0x385}));
}

TEST(StandardPdos, SendTheStatuswordWithSyncWhereTheDriveCannotRepeatItByItself) {
  DriveProfile profile = EasyProfile();
  const auto status = [&profile] { return StandardPdos(profile).at(3); };
  EXPECT_EQ(status().transmission_type, 255);
  EXPECT_EQ(status().event_timer_ms, 8);
  profile.quirks.lacks_tpdo_event_timer = true;
  EXPECT_EQ(status().transmission_type, 1);
  EXPECT_EQ(status().event_timer_ms, std::nullopt);
  EXPECT_EQ(CheckProfile(profile), Findings{});
}

TEST(StandardPdos, LeaveOutAnErrorCodeThatTheDriveLacks) {
  DriveProfile profile = EasyProfile();
  EXPECT_EQ(StandardPdos(profile).at(3).entries.size(), 3U);
  profile.quirks.absent_objects = {0x603F};
  EXPECT_EQ(StandardPdos(profile).at(3).entries,
            (std::vector<PdoEntry>{{{0x6041, 0}, 16}, {{0x6061, 0}, 8}}));
  EXPECT_EQ(CheckProfile(profile), Findings{});
}

TEST(StandardPdos, MapTheDigitalInputsOnlyWhereSomethingIsReadFromThem) {
  DriveProfile profile = EasyProfile();
  EXPECT_EQ(StandardPdos(profile).back().entries.size(), 1U);
  profile.safe_torque_off = {BitSource::From::kDigitalInputs, 0x10000, true};
  EXPECT_EQ(StandardPdos(profile).back().entries.back(), (PdoEntry{{0x60FD, 0}, 32}));
}

}  // namespace
}  // namespace strainwave::protocols::canopen::profile_check_test
