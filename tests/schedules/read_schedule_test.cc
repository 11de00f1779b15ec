// SPDX-License-Identifier: Apache-2.0
#include "schedules/reader/read_schedule.h"

#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <variant>

#include "tests/schedules/schedule_text.h"

namespace strainwave::schedules::read_schedule_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRounding = 1e-12;

TEST(ReadSchedule, ReadsEveryValueInSi) {
  const Schedule schedule = ParseSchedule(GoodSchedule(), "small.yaml");
  EXPECT_EQ(schedule.name, "small");
  EXPECT_EQ(schedule.file_name, "small.yaml");
  EXPECT_EQ(schedule.specimen.identity, "SN-1");
  EXPECT_EQ(schedule.specimen.ratio, 80.0);
  EXPECT_EQ(schedule.specimen.t2_Nm, 25.0);
  EXPECT_EQ(schedule.specimen.bearing_l10_s, 7000.0 * 3600.0);
  EXPECT_EQ(schedule.specimen.circular_spline_teeth, 162);
  EXPECT_NEAR(schedule.limits.input_speed_rad_per_s, 100.0 * kPi, kRounding * 1e3);
  EXPECT_NEAR(schedule.limits.twist_rad, kPi / 360.0, kRounding);
  EXPECT_EQ(schedule.cycles, 3);
  ASSERT_EQ(schedule.phases.size(), 3U);
  const auto& run = std::get<LoadRun>(schedule.phases[0].parameters);
  EXPECT_EQ(run.duration_s, 1800.0);
  EXPECT_EQ(run.output_torque_Nm, 40.0);
  EXPECT_EQ(schedule.phases[0].line, 25);
  EXPECT_EQ(schedule.phases[1].name, "hysteresis");
}

TEST(ReadSchedule, FillsInTheDocumentedDefaults) {
  const Schedule schedule = ParseSchedule(GoodSchedule(), "small.yaml");
  EXPECT_EQ(schedule.suspend.trip_temperature_degC, 70.0);
  EXPECT_EQ(schedule.suspend.resume_temperature_degC, 60.0);
  EXPECT_EQ(schedule.suspend.dwell_s, 60.0);
  EXPECT_EQ(schedule.measurements.retries, 1);
  EXPECT_EQ(schedule.measurements.on_failed_check, OnFailedCheck::kStoreFlagged);
  EXPECT_EQ(schedule.measurements.repeatability_repeats, 5);
  EXPECT_TRUE(schedule.resume.operator_acknowledges);
  EXPECT_EQ(schedule.resume.longest_pause_s, 72.0 * 3600.0);
  EXPECT_FALSE(schedule.stop.k2_below_share_of_first.has_value());
  EXPECT_TRUE(schedule.preparation.empty());
  const auto& sweep = std::get<TransmissionErrorSweep>(schedule.phases[2].parameters);
  EXPECT_EQ(sweep.steps, 360);
  EXPECT_TRUE(sweep.clockwise && sweep.counter_clockwise);
}

TEST(ReadSchedule, ReadsOneLockAngleOrAList) {
  const auto angles = [](std::string_view text) {
    const Schedule schedule = ParseSchedule(With(GoodSchedule(), "peak_torque: 34 Nm",
                                                 "peak_torque: 34 Nm\n    lock_angles: " + std::string(text)),
                                            "s");
    return std::get<HysteresisTest>(schedule.phases[1].parameters).lock_angles_rad;
  };
  ASSERT_EQ(angles("45 deg").size(), 1U);
  EXPECT_NEAR(angles("45 deg")[0], kPi / 4.0, kRounding);
  ASSERT_EQ(angles("[0 deg, 90 deg]").size(), 2U);
  EXPECT_NEAR(angles("[0 deg, 90 deg]")[1], kPi / 2.0, kRounding);
}

TEST(ReadSchedule, NamesAnUnknownKey) {
  EXPECT_EQ(
      MessageOf(With(GoodSchedule(), "cycles: 3", "cycles: 3\ncolour: red")),
      "small.yaml:24:1: error: unknown key 'colour' (expected schedule, name, specimen, limits, suspend, "
      "cycles, preparation, phases, stop, measurements, resume)");
}

TEST(ReadSchedule, SuggestsTheKeyThatWasMeantAndDoesNotCallItMissing) {
  EXPECT_EQ(
      MessageOf(With(GoodSchedule(), "    duration", "    durration")),
      "small.yaml:26:5: error: unknown key 'durration', did you mean 'duration'? (expected kind, duration, "
      "output_torque, input_speed, turns, input_acceleration, torque_rate, log_rate, vibration_statistics, "
      "torque_tolerance, speed_tolerance, tolerance_dwell, name, record)");
  EXPECT_EQ(MessageOf(With(GoodSchedule(), "limits:", "limit:")),
            "small.yaml:17:1: error: unknown key 'limit', did you mean 'limits'? (expected schedule, name, "
            "specimen, limits, suspend, cycles, preparation, phases, stop, measurements, resume)");
  EXPECT_EQ(
      MessageOf(With(GoodSchedule(), "kind: hysteresis", "kinds: hysteresis")),
      "small.yaml:29:5: error: unknown key 'kinds', did you mean 'kind'? (expected kind, name, record)");
}

TEST(ReadSchedule, NamesAMissingKey) {
  EXPECT_EQ(MessageOf(With(GoodSchedule(), "    duration: 30 min\n", "")),
            "small.yaml:25:5: error: missing key 'duration' (expected a time above zero in us, ms, s, min, h "
            "or d)");
  EXPECT_EQ(MessageOf(With(GoodSchedule(), "cycles: 3\n", "")),
            "small.yaml:1:1: error: missing key 'cycles' (expected a whole number from 1 to 10000000)");
  EXPECT_EQ(MessageOf("schedule: 1\n"),
            "small.yaml:1:1: error: missing key 'name' (expected 1 to 64 letters, digits, '-' and '_')\n"
            "small.yaml:1:1: error: missing key 'specimen' (expected a section with keys of its own)\n"
            "small.yaml:1:1: error: missing key 'limits' (expected a section with keys of its own)\n"
            "small.yaml:1:1: error: missing key 'cycles' (expected a whole number from 1 to 10000000)\n"
            "small.yaml:1:1: error: missing key 'phases' (expected a list whose items begin with '- ')\n"
            "small.yaml:1:1: error: missing key 'measurements' (expected a section with keys of its own)");
}

TEST(ReadSchedule, NamesAKeyThatIsThereTwice) {
  EXPECT_EQ(MessageOf(With(GoodSchedule(), "cycles: 3", "cycles: 3\ncycles: 4")),
            "small.yaml:24:1: error: key 'cycles' is there twice (expected once; it is already on line 23)");
}

TEST(ReadSchedule, NamesAWrongUnitWithItsPlace) {
  EXPECT_EQ(MessageOf(With(GoodSchedule(), "30 min", "30 Nm")),
            "small.yaml:26:15: error: duration = 30 Nm: 'Nm' is not a unit of time (expected us, ms, s, min, "
            "h or d)");
  EXPECT_EQ(MessageOf(With(GoodSchedule(), "30 min", "30")),
            "small.yaml:26:15: error: duration = 30: no unit (expected us, ms, s, min, h or d)");
}

TEST(ReadSchedule, NamesANegativeOrZeroDuration) {
  EXPECT_EQ(MessageOf(With(GoodSchedule(), "30 min", "-30 min")),
            "small.yaml:26:15: error: duration = -30 min: negative (expected a time above zero in us, ms, s, "
            "min, h "
            "or d)");
  EXPECT_EQ(MessageOf(With(GoodSchedule(), "30 min", "0 min")),
            "small.yaml:26:15: error: duration = 0 min: zero (expected a time above zero in us, ms, s, min, "
            "h or d)");
}

TEST(ReadSchedule, NamesAValueOfTheWrongShape) {
  EXPECT_EQ(MessageOf(With(GoodSchedule(), "cycles: 3", "cycles:")),
            "small.yaml:23:1: error: cycles has no value (expected a whole number from 1 to 10000000)");
  EXPECT_EQ(MessageOf(With(GoodSchedule(), "cycles: 3", "cycles: [3]")),
            "small.yaml:23:9: error: cycles is a list (expected a whole number from 1 to 10000000)");
  EXPECT_EQ(MessageOf(With(GoodSchedule(), "cycles: 3", "cycles: 2.5")),
            "small.yaml:23:9: error: cycles = 2.5: not whole (expected a whole number from 1 to 10000000)");
  EXPECT_EQ(MessageOf(With(GoodSchedule(), "phases:\n", "phases:\n  - hello\n")),
            "small.yaml:25:5: error: an item of phases is a single value (expected keys with values)");
}

TEST(ReadSchedule, NamesAnUnknownKind) {
  EXPECT_EQ(
      MessageOf(With(GoodSchedule(), "kind: hysteresis", "kind: histeresis")),
      "small.yaml:29:11: error: kind = histeresis: not known; did you mean 'hysteresis'? (expected load_run, "
      "measurement_rotation, transmission_error, hysteresis, soak, blank_test, zero_check, shunt_check or "
      "reference_check)");
}

TEST(ReadSchedule, WantsABlankTestThatCanBeEvaluated) {
  EXPECT_EQ(
      MessageOf(With(GoodSchedule(), "phases:\n",
                     "preparation:\n  - kind: blank_test\n    peak_torque: 7 Nm\n    steps: 15\nphases:\n")),
      "small.yaml:27:12: error: steps = 15: out of range (expected a whole number from 16 to 1000000)");
}

TEST(ReadSchedule, NamesAWrongVersion) {
  EXPECT_EQ(
      MessageOf(With(GoodSchedule(), "schedule: 1", "schedule: 2")),
      "small.yaml:1:11: error: schedule = 2: not a known version (expected 'schedule: 1', the version of the "
      "format)");
}

TEST(ReadSchedule, ReportsAllErrorsAtOnceInTheOrderOfTheFile) {
  std::string text = GoodSchedule();
  text = With(text, "t1: 7 Nm", "t1: 26 Nm");
  text = With(text, "input_speed: 3000 rpm", "input_speed: 3000 Nm");
  text = With(text, "cycles: 3", "cycles: none");
  text = With(text, "duration: 30 min", "duration: -1 s");
  text = With(text, "output_torque: 40 Nm", "output_torque: 61 Nm");
  text = With(text, "kind: hysteresis", "kind: hysteresis\n    name: load_run");
  text = With(text, "declared_temperature", "declared_temprature");
  EXPECT_EQ(
      MessageOf(text),
      "small.yaml:7:7: error: t1 = 26 Nm is above t2 = 25 Nm (line 8)\n"
      "small.yaml:19:16: error: input_speed = 3000 Nm: 'Nm' is not a unit of speed (expected rpm, rad/s or "
      "deg/s)\n"
      "small.yaml:23:9: error: cycles = none: not a number (expected a plain number, as in '0.5')\n"
      "small.yaml:26:15: error: duration = -1 s: negative (expected a time above zero in us, ms, s, min, h "
      "or "
      "d)\n"
      "small.yaml:27:20: error: output_torque = 61 Nm is above output_torque = 60 Nm (line 18)\n"
      "small.yaml:30:11: error: two phases are named 'load_run' (expected a name of its own; the first is on "
      "line 25)\n"
      "small.yaml:35:3: error: unknown key 'declared_temprature', did you mean 'declared_temperature'? "
      "(expected declared_temperature, temperature_tolerance, retries, on_failed_check, "
      "repeatability_repeats)");
}

TEST(ReadSchedule, CountsWhatIsTooMuchToTell) {
  std::string text = GoodSchedule();
  for (int i = 0; i < 1500; ++i) text += "extra_" + std::to_string(i) + ": 1\n";
  try {
    ParseSchedule(text, "small.yaml");
    FAIL() << "taken";
  } catch (const ScheduleError& error) {
    EXPECT_EQ(error.findings().size(), 1000U);
    EXPECT_TRUE(std::string(error.what()).ends_with("\nsmall.yaml: error: and 500 more"));
  }
}

TEST(ReadSchedule, CarriesTheFindingsBesideTheText) {
  try {
    ParseSchedule(With(GoodSchedule(), "30 min", "30 Nm"), "small.yaml");
    FAIL() << "taken";
  } catch (const ScheduleError& error) {
    ASSERT_EQ(error.findings().size(), 1U);
    EXPECT_EQ(error.findings()[0].line, 26);
    EXPECT_EQ(error.findings()[0].column, 15);
  }
}

std::string WithChecks() {
  return With(GoodSchedule(), "  - kind: load_run\n", R"(  - kind: zero_check
    allowed: 500 mNm
    record: [encoders, accelerometers]
  - kind: shunt_check
    expected: 50 Nm
    allowed: 0.3 Nm
    on_failure: mark
  - kind: reference_check
    allowed: 30 arcmin
    duration: 1 s
  - kind: load_run
    vibration_statistics: 12.8 kHz
)");
}

TEST(ReadSchedule, ReadsChecksOfSensors) {
  const Schedule schedule = ParseSchedule(WithChecks(), "small.yaml");
  const auto& zero = std::get<SensorCheck>(schedule.phases[0].parameters);
  EXPECT_EQ(schedule.phases[0].name, "zero_check");
  EXPECT_EQ(schedule.phases[0].recorded_sources, (std::vector<std::string>{"encoders", "accelerometers"}));
  EXPECT_EQ(zero.kind, SensorCheck::Kind::kZero);
  EXPECT_EQ(zero.allowed, 0.5);
  EXPECT_EQ(zero.most_noise, 0.5);
  EXPECT_EQ(zero.duration_s, 2.0);
  EXPECT_TRUE(zero.stops);
  const auto& shunt = std::get<SensorCheck>(schedule.phases[1].parameters);
  EXPECT_EQ(schedule.phases[1].name, "shunt_check");
  EXPECT_EQ(shunt.expected_Nm, 50.0);
  EXPECT_FALSE(shunt.stops);
  const auto& reference = std::get<SensorCheck>(schedule.phases[2].parameters);
  EXPECT_EQ(schedule.phases[2].name, "reference_check");
  EXPECT_NEAR(reference.allowed, 30.0 / 60.0 * kPi / 180.0, kRounding);
  EXPECT_NEAR(reference.most_noise, kPi / 180.0 / 60.0, kRounding);
  EXPECT_EQ(std::get<LoadRun>(schedule.phases[3].parameters).vibration_statistics_hz, 12800.0);
}

TEST(ReadSchedule, RefusesChecksThatCannotBeJudged) {
  EXPECT_EQ(
      MessageOf(With(WithChecks(), "    expected: 50 Nm\n", "")),
      "small.yaml:28:5: error: missing key 'expected' (expected a torque other than zero in Nm, mNm, Ncm "
      "or kNm)");
  EXPECT_EQ(MessageOf(With(WithChecks(), "expected: 50 Nm", "expected: 70 Nm")),
            "small.yaml:29:15: error: expected = 70 Nm is above output_torque = 60 Nm (line 18)");
  EXPECT_EQ(MessageOf(With(WithChecks(), "allowed: 30 arcmin", "allowed: 0.3 Nm")),
            "small.yaml:33:14: error: allowed = 0.3 Nm: 'Nm' is not a unit of angle (expected arcsec, "
            "arcmin, deg, rad, mrad or rev)");
  EXPECT_EQ(MessageOf(With(WithChecks(), "on_failure: mark", "on_failure: warn")),
            "small.yaml:31:17: error: on_failure = warn: not known (expected stop or mark)");
}

}  // namespace
}  // namespace strainwave::schedules::read_schedule_test
