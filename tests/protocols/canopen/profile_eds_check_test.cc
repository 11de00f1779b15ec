// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "protocols/canopen/drive_profile.h"
#include "tests/protocols/canopen/scripted_drive.h"

namespace strainwave::protocols::canopen::profile_eds_check_test {
namespace {

using Findings = std::vector<std::string>;
using enum DataType;
using enum AccessType;

// The objects that IEC 61800-7-201 and CiA 301 give a drive, as a maker's EDS lists them.
EdsFile EasyEds() {
  EdsFile eds;
  eds.vendor_number = 0x29C;
  eds.product_number = 0x17;
  eds.revision_number = 0x10002;
  const auto add = [&eds](std::uint16_t index, std::uint8_t subindex, const char* name, DataType type,
                          AccessType access, bool mappable = false) {
    eds.objects[{index, subindex}] = {std::string(name), type, access, mappable, {}, {}, {}};
  };
  add(0x1000, 0, "Device type", kUnsigned32, kReadOnly);
  add(0x1014, 0, "COB-ID of emergencies", kUnsigned32, kReadWrite);
  add(0x1016, 1, "Consumer heartbeat time", kUnsigned32, kReadWrite);
  add(0x1017, 0, "Producer heartbeat time", kUnsigned16, kReadWrite);
  add(0x1018, 1, "Vendor", kUnsigned32, kReadOnly);
  add(0x1018, 2, "Product", kUnsigned32, kReadOnly);
  add(0x1029, 1, "Communication error", kUnsigned8, kReadWrite);
  for (std::uint16_t i = 0; i < 3; ++i) {
    for (const std::uint16_t base : {std::uint16_t{0x1400}, std::uint16_t{0x1800}}) {
      const auto index = static_cast<std::uint16_t>(base + i);
      add(index, 1, "COB-ID", kUnsigned32, kReadWrite);
      add(index, 2, "Transmission type", kUnsigned8, kReadWrite);
      add(index, 5, "Event timer", kUnsigned16, kReadWrite);
      add(static_cast<std::uint16_t>(index + 0x200), 0, "Entries", kUnsigned8, kReadWrite);
      for (std::uint8_t entry = 1; entry <= 8; ++entry) {
        add(static_cast<std::uint16_t>(index + 0x200), entry, "Entry", kUnsigned32, kReadWrite);
      }
    }
  }
  add(0x6007, 0, "Abort connection option code", kInteger16, kReadWrite);
  add(0x603F, 0, "Error code", kUnsigned16, kReadOnly, true);
  add(0x6040, 0, "Controlword", kUnsigned16, kReadWrite, true);
  add(0x6041, 0, "Statusword", kUnsigned16, kReadOnly, true);
  add(0x605A, 0, "Quick stop option code", kInteger16, kReadWrite);
  add(0x605B, 0, "Shutdown option code", kInteger16, kReadWrite);
  add(0x605C, 0, "Disable operation option code", kInteger16, kReadWrite);
  add(0x605D, 0, "Halt option code", kInteger16, kReadWrite);
  add(0x605E, 0, "Fault reaction option code", kInteger16, kReadWrite);
  add(0x6060, 0, "Modes of operation", kInteger8, kReadWrite, true);
  add(0x6061, 0, "Modes of operation display", kInteger8, kReadOnly, true);
  add(0x6064, 0, "Position actual value", kInteger32, kReadOnly, true);
  add(0x6065, 0, "Following error window", kUnsigned32, kReadWrite);
  add(0x6066, 0, "Following error time out", kUnsigned16, kReadWrite);
  add(0x606C, 0, "Velocity actual value", kInteger32, kReadOnly, true);
  add(0x6071, 0, "Target torque", kInteger16, kReadWrite, true);
  add(0x6072, 0, "Max torque", kUnsigned16, kReadWrite);
  add(0x6076, 0, "Motor rated torque", kUnsigned32, kReadOnly);
  add(0x6077, 0, "Torque actual value", kInteger16, kReadOnly, true);
  add(0x607A, 0, "Target position", kInteger32, kReadWrite, true);
  add(0x607F, 0, "Max profile velocity", kUnsigned32, kReadWrite);
  add(0x6081, 0, "Profile velocity", kUnsigned32, kReadWrite);
  add(0x6083, 0, "Profile acceleration", kUnsigned32, kReadWrite);
  add(0x6084, 0, "Profile deceleration", kUnsigned32, kReadWrite);
  add(0x6085, 0, "Quick stop deceleration", kUnsigned32, kReadWrite);
  add(0x60C2, 1, "Interpolation time period", kUnsigned8, kReadWrite);
  add(0x60C2, 2, "Interpolation time index", kInteger8, kReadWrite);
  add(0x60FE, 1, "Physical outputs", kUnsigned32, kReadWrite, true);
  add(0x60FF, 0, "Target velocity", kInteger32, kReadWrite, true);
  add(0x6502, 0, "Supported drive modes", kUnsigned32, kReadOnly);
  return eds;
}

Findings WhatOf(const std::vector<FileNote>& notes) {
  Findings words;
  for (const FileNote& note : notes) words.push_back(note.what);
  return words;
}

template <typename Change>
Findings CheckWith(Change change) {
  DriveProfile profile = EasyProfile();
  EdsFile eds = EasyEds();
  change(profile, eds);
  return WhatOf(CheckProfileAgainstEds(profile, eds, 3));
}

// Point 12.
TEST(CheckProfileAgainstEds, FindsNothingWhereBothAgree) {
  EXPECT_EQ(WhatOf(CheckProfileAgainstEds(EasyProfile(), EasyEds(), 3)), Findings{});
}

TEST(CheckProfileAgainstEds, FindsAnotherDrive) {
  EXPECT_EQ(CheckWith([](DriveProfile& p, EdsFile&) { p.identity.product = 0x18; }),
            (Findings{"product 00000018h in the profile, 00000017h in the EDS"}));
}

TEST(CheckProfileAgainstEds, FindsObjectsThatTheDriveLacks) {
  EXPECT_EQ(
      CheckWith([](DriveProfile&, EdsFile& eds) {
        eds.objects.erase({0x605A, 0});
        eds.objects.erase({0x6077, 0});
      }),
      (Findings{
          "605Ah:00 (quick stop option code) is not in the EDS (expected it there; where the drive lacks it, "
          "quirks: {absent_objects: [0x605A]} in the profile)",
          "6077h:00 is mapped, but is not in the EDS (expected it there; the master cannot do without it)"}));
}

TEST(CheckProfileAgainstEds, FindsAnAbsentObjectThatIsThere) {
  EXPECT_EQ(CheckWith([](DriveProfile& p, EdsFile&) {
              p.quirks.absent_objects = {0x605E, 0x605F};
            }),
            (Findings{"605Eh is absent according to the profile, but is in the EDS"}));
}

TEST(CheckProfileAgainstEds, NamesNoKeyForWhatADriveMustHave) {
  EXPECT_EQ(
      CheckWith([](DriveProfile&, EdsFile& eds) {
        eds.objects.erase({0x1017, 0});
        eds.objects.erase({0x1400, 5});
      }),
      (Findings{"1017h:00 (heartbeat of the drive) is not in the EDS: a drive without heartbeats (1016h, "
                "1017h) cannot be watched",
                "1400h:05 (RPDO 1) is not in the EDS (expected it there; where the drive lacks it, quirks: "
                "{lacks_rpdo_event_timer: true} in the profile)"}));
}

// Without their mapping, PDOs would carry what somebody has once set.
TEST(CheckProfileAgainstEds, NeverAdvisesToLeaveOutPdos) {
  EXPECT_EQ(CheckWith([](DriveProfile&, EdsFile& eds) {
              eds.objects.erase({0x1600, 2});
            }),
            (Findings{"1600h:02 (RPDO 1) is not in the EDS (expected it there; the profile's pdos may name "
                      "others)"}));
  EXPECT_EQ(CheckWith([](DriveProfile& p, EdsFile& eds) {
              p.pdos = StandardPdos(p);
              eds.objects.erase({0x1800, 5});
            }),
            (Findings{"1800h:05 (TPDO 1) is not in the EDS (expected only PDOs and entries that the drive "
                      "has in pdos)"}));
}

TEST(CheckProfileAgainstEds, TakesADriveThatCannotRepeatItsStatusword) {
  EXPECT_EQ(CheckWith([](DriveProfile&, EdsFile& eds) {
              eds.objects.erase({0x1800, 5});
            }),
            (Findings{"1800h:05 (TPDO 1) is not in the EDS (expected it there; where the drive lacks it, "
                      "quirks: {lacks_tpdo_event_timer: true} in the profile)"}));
  EXPECT_EQ(CheckWith([](DriveProfile& p, EdsFile& eds) {
              eds.objects.erase({0x1800, 5});
              p.quirks.lacks_tpdo_event_timer = true;
            }),
            Findings{});
}

TEST(CheckProfileAgainstEds, TakesADriveThatCannotMapItsErrorCode) {
  const std::string how =
      " (expected it there; where the drive lacks it, quirks: {absent_objects: [0x603F]} in the profile)";
  EXPECT_EQ(CheckWith([](DriveProfile&, EdsFile& eds) {
              eds.objects.erase({0x603F, 0});
            }),
            (Findings{"603Fh:00 is mapped, but is not in the EDS" + how}));
  EXPECT_EQ(CheckWith([](DriveProfile&, EdsFile& eds) {
              eds.objects[{0x603F, 0}].mappable = false;
            }),
            (Findings{"603Fh:00 Error code: is mapped, but the EDS does not allow it" + how}));
  EXPECT_EQ(CheckWith([](DriveProfile& p, EdsFile& eds) {
              eds.objects[{0x603F, 0}].mappable = false;
              p.quirks.absent_objects = {0x603F};
            }),
            Findings{});
}

TEST(CheckProfileAgainstEds, SaysWhereOtherPdosAreAWayOut) {
  EXPECT_EQ(CheckWith([](DriveProfile& p, EdsFile& eds) {
              p.modes = {OperationMode::kProfileVelocity};
              eds.objects.erase({0x607A, 0});
            }),
            (Findings{"607Ah:00 is mapped, but is not in the EDS (expected it there; the profile's pdos may "
                      "do without it)"}));
}

TEST(CheckProfileAgainstEds, GivesThePlaceOfWhatDoesNotFit) {
  EdsFile eds = EasyEds();
  EdsObject& written = eds.objects[{0x6085, 0}];
  written.access = kConstant;
  written.section_place = {70, 1};
  written.access_place = {74, 12};
  eds.objects[{0x6072, 0}].low_limit = "2001";
  eds.objects[{0x6072, 0}].low_place = {80, 10};
  eds.objects[{0x6065, 0}].type = kUnsigned16;
  eds.objects[{0x6065, 0}].type_place = {90, 13};
  eds.objects[{0x60FE, 1}].mappable = false;
  eds.objects[{0x60FE, 1}].mapping_place = {99, 14};
  eds.objects[{0x1400, 0}].section_place = {40, 1};
  eds.objects.erase({0x1400, 5});
  eds.objects.erase({0x605A, 0});
  std::map<std::string, std::pair<int, int>> places;
  for (const FileNote& note : CheckProfileAgainstEds(EasyProfile(), eds, 3))
    places[note.what.substr(0, 8)] = {note.line, note.column};
  const std::map<std::string, std::pair<int, int>> expected{{"6085h:00", {74, 12}}, {"6072h:00", {80, 10}},
                                                            {"6065h:00", {90, 13}}, {"60FEh:01", {99, 14}},
                                                            {"1400h:05", {40, 1}},  {"605Ah:00", {1, 1}}};
  EXPECT_EQ(places, expected);
}

// The upper half of the object is the watched node, which no limit of 16 bits leaves room for.
TEST(CheckProfileAgainstEds, TakesALimitOfTheHeartbeatsTimeForWhatItIs) {
  const auto findings = [](const std::string& high_limit) {
    return CheckWith([&](DriveProfile& p, EdsFile& eds) {
      p.supervision.master_timeout_ms = 150;
      eds.objects[{0x1016, 1}].high_limit = high_limit;
    });
  };
  EXPECT_EQ(findings("65535"), Findings{});
  EXPECT_EQ(findings("149"),
            (Findings{"1016h:01 Consumer heartbeat time: 150 is above the EDS's high limit 149"}));
  EXPECT_EQ(findings("0x10000"),
            (Findings{"1016h:01 Consumer heartbeat time: 8323222 is above the EDS's high limit 65536"}));
}

TEST(CheckProfileAgainstEds, LetsTheProfileNotLookAtWhatIsOnlyRead) {
  EXPECT_EQ(CheckWith([](DriveProfile& p, EdsFile&) { p.quirks.absent_objects = {0x6076}; }), Findings{});
}

TEST(CheckProfileAgainstEds, ComparesNoIdentityThatTheEdsDoesNotGive) {
  EXPECT_EQ(CheckWith([](DriveProfile& p, EdsFile& eds) {
              p.identity.product = 0x18;
              eds.product_number.reset();
            }),
            Findings{});
  EXPECT_EQ(CheckWith([](DriveProfile& p, EdsFile& eds) {
              p.identity.product = 0x18;
              eds.product_number = 0;
            }),
            Findings{});
}

TEST(CheckProfileAgainstEds, FindsATouchedObjectThatTheEdsLeavesUnclear) {
  EXPECT_EQ(CheckWith([](DriveProfile&, EdsFile& eds) {
              eds.objects[{0x6085, 0}].unclear = "no DataType that is known here";
              eds.objects[{0x2000, 0}].unclear = "no DataType that is known here";
            }),
            (Findings{"6085h:00 Quick stop deceleration: the EDS gives it no DataType that is known here"}));
}

TEST(CheckProfileAgainstEds, ReadsHexadecimalLimitsOfSignedTypes) {
  EXPECT_EQ(CheckWith([](DriveProfile& p, EdsFile& eds) {
              p.option_codes.quick_stop = -1;
              eds.objects[{0x605A, 0}].low_limit = "0x8000";
              eds.objects[{0x605A, 0}].high_limit = "0x7FFF";
            }),
            Findings{});
}

TEST(CheckProfileAgainstEds, FindsAnObjectThatCannotBeWrittenOrRead) {
  EXPECT_EQ(CheckWith([](DriveProfile&, EdsFile& eds) {
              eds.objects[{0x6085, 0}].access = kConstant;
              eds.objects[{0x6065, 0}].access = kWriteOnly;
            }),
            (Findings{"6085h:00 Quick stop deceleration: is written, but can only be read",
                      "6065h:00 Following error window: is read, but can only be written"}));
}

TEST(CheckProfileAgainstEds, FindsAnotherLength) {
  EXPECT_EQ(CheckWith([](DriveProfile&, EdsFile& eds) {
              eds.objects[{0x6065, 0}].type = kUnsigned16;
            }),
            (Findings{"6065h:00 Following error window: 4 bytes in the profile, 2 in the EDS"}));
}

TEST(CheckProfileAgainstEds, FindsValuesOutsideTheLimitsOfTheEds) {
  EXPECT_EQ(CheckWith([](DriveProfile& p, EdsFile& eds) {
              p.option_codes.quick_stop = -1;
              const std::tuple<ObjectAddress, std::string, std::string> limits[] = {
                  {{0x605A, 0}, "0", ""},     {{0x6072, 0}, "2001", ""},
                  {{0x607F, 0}, "", "0xBB7"},  // 2999
                  {{0x60C2, 2}, "-2", "0"},   {{0x1800, 1}, "$NODEID+0x180", ""},
              };
              for (const auto& [address, low, high] : limits) {
                eds.objects[address].low_limit = low;
                eds.objects[address].high_limit = high;
              }
            }),
            (Findings{"605Ah:00 Quick stop option code: -1 is below the EDS's low limit 0",
                      "6072h:00 Max torque: 2000 is below the EDS's low limit 2001",
                      "607Fh:00 Max profile velocity: 3000 is above the EDS's high limit 2999",
                      "60C2h:02 Interpolation time index: -3 is below the EDS's low limit -2"}));
}

TEST(CheckProfileAgainstEds, FindsWhatCannotBeMapped) {
  EXPECT_EQ(CheckWith([](DriveProfile&, EdsFile& eds) {
              eds.objects[{0x60FE, 1}].mappable = false;
              eds.objects[{0x6060, 0}].access = kReadOnly;
              eds.objects[{0x6064, 0}].type = kInteger16;
            }),
            (Findings{"6060h:00 Modes of operation: is mapped to be written, but can only be read",
                      "60FEh:01 Physical outputs: is mapped, but the EDS does not allow it (expected it "
                      "there; the master cannot do without it)",
                      "6064h:00 Position actual value: 32 bits mapped, 16 in the EDS"}));
}

}  // namespace
}  // namespace strainwave::protocols::canopen::profile_eds_check_test
