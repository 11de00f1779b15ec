// SPDX-License-Identifier: Apache-2.0
#include "bench/configuration/read_drive_profile.h"

#include <string>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/checkout.h"
#include "tests/schedules/schedule_text.h"

namespace strainwave::bench::drive_profile_test {
namespace {

using protocols::OperationMode;
using protocols::canopen::BitSource;
using protocols::canopen::BrakeControl;
using schedules::With;

std::string SmallProfile() {
  return R"(drive_profile: 1
name: small
modes: [pv, csv]
units: {counts_per_rev: 4096, rated_torque: 2 Nm}
limits:
  speed: 3000 rpm
  torque: 4 Nm
  acceleration: 100 rad/s2
  quick_stop_deceleration: 200 rad/s2
  following_error_window: 10 deg
quirks: {absent_objects: [0x605B, 0x605C], warning_codes: 0x3210}
)";
}

std::string MessageOf(const std::string& text, const std::filesystem::path& folder = {}) {
  try {
    ParseDriveProfile(text, "small.yaml", folder);
    return {};
  } catch (const BenchFileError& error) {
    return error.what();
  }
}

TEST(DriveProfileFile, GivesWhatItSaysAndSafeDefaults) {
  const auto profile = ParseDriveProfile(SmallProfile(), "small.yaml");
  EXPECT_EQ(profile.modes,
            (std::vector<OperationMode>{OperationMode::kProfileVelocity, OperationMode::kCyclicVelocity}));
  EXPECT_EQ(profile.units.position_counts_per_rev, 4096.0);
  EXPECT_DOUBLE_EQ(profile.limits.max_speed_rad_per_s, RadPerSFromRpm(3000.0));
  EXPECT_EQ(profile.quirks.absent_objects, (std::vector<std::uint16_t>{0x605B, 0x605C}));
  EXPECT_EQ(profile.quirks.warning_codes, (std::vector<std::uint16_t>{0x3210}));
  // A profile that says nothing of supervision has it.
  EXPECT_EQ(profile.supervision.master_timeout_ms, 150);
  EXPECT_EQ(profile.option_codes.abort_connection, 3);
  EXPECT_EQ(profile.brake.by, BrakeControl::By::kDrive);
  EXPECT_EQ(profile.safe_torque_off.from, BitSource::From::kNowhere);
}

TEST(DriveProfileFile, IsThatOfTheAxisBehindItsReducer) {
  const auto motor = ParseDriveProfile(SmallProfile(), "small.yaml");
  const auto axis = AtAxis(motor, 70.0, -1);
  EXPECT_DOUBLE_EQ(axis.limits.max_torque_Nm, 280.0);
  EXPECT_DOUBLE_EQ(axis.limits.max_speed_rad_per_s, RadPerSFromRpm(3000.0) / 70.0);
  // One turn of the axis backwards is seventy turns of the motor forwards.
  EXPECT_EQ(protocols::canopen::PositionCounts(axis.units, -kTwoPi), 70 * 4096);
  EXPECT_EQ(protocols::canopen::TorquePerMille(axis.units, 140.0), -1000);
}

TEST(DriveProfileFile, TellsAllThatIsWrongWithPlaces) {
  EXPECT_EQ(
      MessageOf(With(With(SmallProfile(), "[pv, csv]", "[pv, fast]"), "4 Nm", "4 rpm")),
      "small.yaml:3:8: error: modes has fast (expected some of pp, pv, tq, homing, csp, csv and cst)\n"
      "small.yaml:7:11: error: torque = 4 rpm: 'rpm' is not a unit of torque (expected Nm, mNm, Ncm or kNm)");
  EXPECT_EQ(
      MessageOf(SmallProfile() + "pdos: [{flow: to_drive, number: 1, cob_id: 0x200, transmission: 254, map: "
                                 "[\"0x6040:0\"]}]\n"),
      "small.yaml:12:75: error: map has 0x6040:0 (expected INDEX:SUBINDEX:BITS, as in 0x6040:0:16)");
}

TEST(DriveProfileFile, SaysInWhichUnitTheDriveHoldsItsRatedTorque) {
  EXPECT_EQ(ParseDriveProfile(SmallProfile(), "small.yaml").units.rated_torque_units_per_Nm, 1e3);
  const std::string micro = With(SmallProfile(), "2 Nm}", "512.9 mNm, rated_torque_unit: uNm}");
  EXPECT_EQ(ParseDriveProfile(micro, "small.yaml").units.rated_torque_units_per_Nm, 1e6);
}

TEST(DriveProfileFile, RefusesToLeaveADriveUnwatched) {
  const std::string unwatched = " is above 2 s (expected no more, since the shafts turn unwatched meanwhile)";
  EXPECT_EQ(MessageOf(SmallProfile() +
                      "supervision: {drive_timeout: 3 s, master_heartbeat: 50 ms, master_timeout: 1 min, "
                      "rpdo_event_timer: 2001 ms}\n"),
            "small.yaml:12:30: error: drive_timeout = 3 s" + unwatched +
                "\nsmall.yaml:12:76: error: master_timeout = 1 min" + unwatched +
                "\nsmall.yaml:12:101: error: rpdo_event_timer = 2001 ms" + unwatched);
  EXPECT_EQ(
      MessageOf(SmallProfile() + "timing: {sync_period: 10 ms, stale_after_syncs: 201}\n"),
      "small.yaml:12:49: error: stale_after_syncs = 201 of the sync_period are 2.01 s (expected at most 2 s, "
      "since the shafts turn unwatched meanwhile)");
  EXPECT_EQ(MessageOf(SmallProfile() + "timing: {sync_period: 10 ms, stale_after_syncs: 200}\n"), "");
}

TEST(DriveProfileFile, IsCheckedAgainstTheMakersDataSheet) {
  EXPECT_EQ(
      MessageOf(SmallProfile() + "eds: missing.eds\n", "nowhere"),
      "small.yaml:12:6: error: eds = missing.eds cannot be read (expected the drive's EDS file beside this "
      "one)");
  const std::filesystem::path profiles = std::filesystem::path(SourceFolder()) / "bench/devices/profiles";
  const std::string messages = MessageOf(
      SmallProfile() + "eds: strainwave_drive.eds\nobjects: [{index: 0x2345, type: unsigned8, value: 1}]\n",
      profiles);
  EXPECT_NE(messages.find("2345h"), std::string::npos) << messages;
}

TEST(DriveProfileFile, OfOurOwnDriveFitsItsDataSheet) {
  const std::filesystem::path file =
      std::filesystem::path(SourceFolder()) / "bench/devices/profiles/strainwave_drive.yaml";
  const auto profile = ReadDriveProfile(file);
  EXPECT_EQ(profile.identity.vendor, 0x5357U);
  EXPECT_EQ(profile.eds_notes, std::vector<std::string>{});
  // 1000 rpm are 65536 / 60 * 1000 increments a second.
  EXPECT_EQ(protocols::canopen::VelocityUnits(profile.units, RadPerSFromRpm(1000.0)), 1092267);
}

}  // namespace
}  // namespace strainwave::bench::drive_profile_test
