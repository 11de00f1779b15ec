// SPDX-License-Identifier: Apache-2.0
#include "bench/trip_test/trip_row.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "bench/configuration/embedded_bench.h"
#include "bench/configuration/sensors_of.h"
#include "bench/errors/bench_error.h"
#include "bench/safety/interlocks.h"
#include "bench/trip_test/simulated_trips.h"
#include "schedules/reader/read_schedule.h"
#include "tests/checkout.h"

namespace strainwave::bench::trip_row_test {
namespace {

std::vector<TripRow> EmbeddedRows() {
  const BenchDescription bench = EmbeddedBench();
  return TripRows(TripSettingsOf(bench), bench);
}

const TripRow& RowOf(const std::vector<TripRow>& rows, StopCause cause) {
  return *std::ranges::find(rows, cause, &TripRow::cause);
}

TEST(TripRows, CoverEveryInterlockOfTheTable) {
  const std::vector<TripRow> rows = EmbeddedRows();
  std::size_t causes = 0;
  for (const InterlockRow& interlock : Interlocks::Table(SensorsOf(EmbeddedBench()))) {
    EXPECT_FALSE(interlock.causes.empty()) << interlock.signal;
    causes += interlock.causes.size();
    for (const StopCause cause : interlock.causes) {
      EXPECT_NE(std::ranges::find(rows, cause, &TripRow::cause), rows.end()) << Code(cause);
    }
  }
  // Five causes for either servo; four channels each that stop and that suspend.
  EXPECT_EQ(rows.size(), causes + 5 + 3 + 3);
}

TEST(TripRows, EachHasAFaultOfTheSimulatedBench) {
  const TripSettings settings = TripSettingsOf(EmbeddedBench());
  for (const TripRow& row : EmbeddedRows()) EXPECT_NO_THROW(InjectionFor(row, settings)) << row.signal;
}

TEST(TripRows, HaveTheLimitsOfTheScheduleInItsUnits) {
  const schedules::Schedule schedule =
      schedules::ReadSchedule(std::filesystem::path(SourceFolder()) / "schedules/quick.yaml");
  const std::vector<TripRow> rows = TripRows(TripSettingsOf(schedule), EmbeddedBench());
  const auto limit = [&](StopCause cause) { return RowOf(rows, cause).limit; };
  EXPECT_NEAR(limit(StopCause::kOutputTorqueLimit).value.value(), 60.0, 1e-9);
  EXPECT_EQ(limit(StopCause::kOutputTorqueLimit).unit, "Nm");
  EXPECT_EQ(limit(StopCause::kOutputTorqueLimit).key, "limits.output_torque");
  EXPECT_NEAR(limit(StopCause::kInputSpeedLimit).value.value(), 3000.0, 1e-9);
  EXPECT_NEAR(limit(StopCause::kTwistLimit).value.value(), 30.0, 1e-9);
  EXPECT_NEAR(limit(StopCause::kTemperatureSuspend).value.value(), 70.0, 1e-9);
  EXPECT_EQ(limit(StopCause::kDriveFault).value, std::nullopt);
  EXPECT_EQ(limit(StopCause::kDriveFault).key, "power state fault");
}

TEST(TripRows, StateTheTimesByTheBenchFile) {
  BenchDescription bench = EmbeddedBench();
  bench.stale_after_s = 0.05;
  bench.control_period_s = 0.01;
  bench.longest_stop_s = 1.5;
  const std::vector<TripRow> rows = TripRows(TripSettingsOf(bench), bench);
  EXPECT_NEAR(RowOf(rows, StopCause::kOutputTorqueLimit).noticed_within_s, 0.06, 1e-12);
  EXPECT_NEAR(RowOf(rows, StopCause::kOutputTorqueLimit).safe_within_s, 1.56, 1e-12);
  EXPECT_NEAR(RowOf(rows, StopCause::kSensorSuspend).noticed_within_s, 2.06, 1e-12);
  EXPECT_NEAR(RowOf(rows, StopCause::kDriveNotReady).noticed_within_s, 3.06, 1e-12);
}

TEST(TripRows, LatchAsTheAlarmsOfTheBenchFileDo) {
  EXPECT_TRUE(RowOf(EmbeddedRows(), StopCause::kTwistLimit).latches);
  EXPECT_FALSE(RowOf(EmbeddedRows(), StopCause::kDriveSilent).latches);
  BenchDescription bench = EmbeddedBench();
  bench.alarms.push_back({.code = "drive_silent", .priority = {}, .latching = true});
  EXPECT_TRUE(RowOf(TripRows(TripSettingsOf(bench), bench), StopCause::kDriveSilent).latches);
}

TEST(TripRows, SayWhatABenchDoesNotWatch) {
  BenchDescription bench = EmbeddedBench();
  bench.accelerometers.clear();
  const std::vector<TripRow> rows = TripRows(TripSettingsOf(bench), bench);
  std::set<std::string> unwatched;
  for (const TripRow& row : rows) {
    if (!row.unwatched.empty()) unwatched.insert(row.signal + ": " + row.unwatched);
  }
  EXPECT_EQ(unwatched, (std::set<std::string>{"vibration RMS: the bench has no accelerometers",
                                              "quick-stop key: the bench has no pendant",
                                              "bad channel, vibration: the bench has no accelerometers"}));
}

TEST(OnlyRows, ChoosesByTheCodeOfTheJournal) {
  const std::vector<TripRow> rows = OnlyRows(EmbeddedRows(), {"twist_limit", "drive_fault"});
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].signal, "twist, input locked");
  EXPECT_EQ(rows[1].signal, "drive fault, driving servo");
  EXPECT_EQ(rows[2].signal, "drive fault, load servo");
  EXPECT_EQ(OnlyRows(EmbeddedRows(), {}).size(), EmbeddedRows().size());
}

TEST(OnlyRows, NamesTheNearestCodeForOneThatThereIsNot) {
  try {
    OnlyRows(EmbeddedRows(), {"drive_falt"});
    FAIL() << "taken";
  } catch (const BenchError& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::kWrongInput);
    EXPECT_STREQ(
        error.what(),
        "--only drive_falt: error: no interlock has this code, did you mean 'drive_fault'? (expected "
        "output_torque_limit, input_speed_limit, gear_temperature_limit, vibration_limit, twist_limit, "
        "stale_readings, implausible_reading, input_angle_apart, drive_fault, drive_not_ready, "
        "drive_dropped_out, brake_engaged, drive_silent, torque_away, speed_away, quick_stop_key, "
        "temperature_suspend or sensor_suspend)");
  }
}

}  // namespace
}  // namespace strainwave::bench::trip_row_test
