// SPDX-License-Identifier: Apache-2.0
#include "schedules/reader/validate_schedule.h"

#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "tests/schedules/schedule_text.h"

namespace strainwave::schedules::validate_schedule_test {
namespace {

// Everything that validation says of a text that the reader takes.
std::string WarningsOf(const std::string& text) {
  std::string lines;
  for (const Finding& finding : ValidateSchedule(ParseSchedule(text, "small.yaml")).items()) {
    lines += FormatFinding("small.yaml", finding) + "\n";
  }
  return lines;
}

std::string GoodWith(std::string_view from, std::string_view to) { return With(GoodSchedule(), from, to); }

TEST(ValidateSchedule, HasNothingToSayOfAGoodOne) { EXPECT_EQ(WarningsOf(GoodSchedule()), ""); }

TEST(ValidateSchedule, WantsTheKneesInOrder) {
  EXPECT_EQ(MessageOf(GoodWith("t1: 7 Nm", "t1: 25.5 Nm")),
            "small.yaml:7:7: error: t1 = 25.5 Nm is above t2 = 25 Nm (line 8)");
  EXPECT_EQ(MessageOf(GoodWith("t1: 7 Nm", "t1: 2500 Ncm")),
            "small.yaml:7:7: error: t1 = 2500 Ncm is not below t2 = 25 Nm (line 8)");
}

TEST(ValidateSchedule, WantsRatioAndTeethToFit) {
  EXPECT_EQ(MessageOf(GoodWith("ratio: 80", "ratio: 50")),
            "small.yaml:6:10: error: ratio = 50 does not fit 160 and 162 teeth (expected 80 or -80)");
  EXPECT_EQ(MessageOf(GoodWith("ratio: 80", "ratio: -80")), "");
  EXPECT_EQ(MessageOf(GoodWith("circular_spline_teeth: 162", "circular_spline_teeth: 160")),
            "small.yaml:16:26: error: circular_spline_teeth = 160 is not above flexspline_teeth = 160 "
            "(expected two "
            "more)");
}

TEST(ValidateSchedule, WantsTwoNamesForTwoPhases) {
  EXPECT_EQ(
      MessageOf(GoodWith("kind: hysteresis", "kind: hysteresis\n    name: load_run")),
      "small.yaml:30:11: error: two phases are named 'load_run' (expected a name of its own; the first is on "
      "line 25)");
  EXPECT_EQ(
      MessageOf(GoodWith("phases:\n", "preparation:\n  - {kind: hysteresis, peak_torque: 34 Nm}\nphases:\n")),
      "small.yaml:31:5: error: two phases are named 'hysteresis' (expected a name of its own; the first is "
      "on "
      "line 25)");
}

TEST(ValidateSchedule, WantsTorqueAndSpeedWithinTheLimits) {
  EXPECT_EQ(MessageOf(GoodWith("output_torque: 40 Nm", "output_torque: 80 Nm")),
            "small.yaml:27:20: error: output_torque = 80 Nm is above output_torque = 60 Nm (line 18)");
  EXPECT_EQ(MessageOf(GoodWith("input_speed: 2400 rpm", "input_speed: 3001 rpm")),
            "small.yaml:28:18: error: input_speed = 3001 rpm is above input_speed = 3000 rpm (line 19)");
}

TEST(ValidateSchedule, WantsTheLimitBelowWhatBreaksTheGear) {
  EXPECT_EQ(MessageOf(GoodWith("output_torque: 60 Nm", "output_torque: 340 Nm")),
            "small.yaml:18:18: error: output_torque = 340 Nm is above buckling_torque = 330 Nm (line 14)");
}

TEST(ValidateSchedule, WarnsOfAMarginBelowTwo) {
  EXPECT_EQ(
      WarningsOf(GoodWith("output_torque: 60 Nm", "output_torque: 170 Nm")),
      "small.yaml:18:18: warning: output_torque = 170 Nm leaves a margin of 1.94 to buckling_torque = 330 Nm "
      "(2 is usual)\n");
}

TEST(ValidateSchedule, WarnsOfATorqueNearTheLimit) {
  EXPECT_EQ(WarningsOf(GoodWith("output_torque: 40 Nm", "output_torque: 58 Nm")),
            "small.yaml:27:20: warning: output_torque = 58 Nm is so near to the limit of 60 Nm that ripple "
            "may trip "
            "it (5 % of room is usual)\n");
}

TEST(ValidateSchedule, WantsTheLockTestToReachT3) {
  EXPECT_EQ(MessageOf(GoodWith("peak_torque: 34 Nm", "peak_torque: 30 Nm")),
            "small.yaml:30:18: error: peak_torque = 30 Nm is below t3 = 34 Nm (line 9)");
}

TEST(ValidateSchedule, WantsEnoughSamplesForTheFirstSlope) {
  EXPECT_EQ(
      MessageOf(GoodWith("peak_torque: 34 Nm", "peak_torque: 34 Nm\n    torque_rate: 50 Nm/s")),
      "small.yaml:31:18: error: torque_rate = 50 Nm/s leaves 7.0 samples up to t1 = 7 Nm at log_rate = 50 Hz "
      "(expected 10 or more)");
}

TEST(ValidateSchedule, WantsALoadRunsLogToFitIntoMemory) {
  // 24 h and a fifth and 61 s, 100 times a second, eleven numbers: 10 374 100 rows of 88 bytes.
  EXPECT_EQ(MessageOf(GoodWith("duration: 30 min", "duration: 24 h\n    log_rate: 100 Hz")),
            "small.yaml:27:15: error: log_rate = 100 Hz over duration = 24 h is a log of 913 MB in memory "
            "(expected at most 256 MB: at most 28 Hz, or a shorter duration and more cycles)");
  EXPECT_EQ(MessageOf(GoodWith("duration: 30 min", "duration: 24 h\n    log_rate: 28 Hz")), "");
}

TEST(ValidateSchedule, WantsWholeTurnsOfTheOutput) {
  EXPECT_EQ(MessageOf(GoodWith("input_speed: 300 rpm", "input_speed: 300 rpm\n    steps: 180")),
            "small.yaml:31:5: error: steps = 180 of step = 1 deg make 180 deg (expected whole turns of the "
            "output, a "
            "multiple of 360 deg)");
  EXPECT_EQ(MessageOf(GoodWith("input_speed: 300 rpm", "input_speed: 300 rpm\n    step: 0.7 deg")),
            "small.yaml:33:11: error: steps = 360 of step = 0.7 deg make 252 deg (expected whole turns of "
            "the output, "
            "a multiple of 360 deg)");
  EXPECT_EQ(
      MessageOf(GoodWith("input_speed: 300 rpm", "input_speed: 300 rpm\n    step: 30 deg")),
      "small.yaml:33:11: error: step = 30 deg makes 12 steps a turn of the output (expected at least 36, or "
      "no sweep passes its checks)");
  EXPECT_EQ(MessageOf(GoodWith("input_speed: 300 rpm", "input_speed: 300 rpm\n    step: 10 deg")), "");
  EXPECT_NE(MessageOf(GoodWith("input_speed: 300 rpm", "input_speed: 300 rpm\n    step: 1e-10 deg")), "");
  EXPECT_EQ(MessageOf(GoodWith("input_speed: 300 rpm", "input_speed: 300 rpm\n    step: 2 deg")), "");
  EXPECT_EQ(
      MessageOf(
          GoodWith("input_speed: 300 rpm",
                   "input_speed: 300 rpm\n  - {kind: measurement_rotation, turns: 1.5, input_speed: 300 "
                   "rpm, output_torque: 0 Nm}")),
      "small.yaml:33:41: error: turns = 1.5 is not whole (expected whole turns of the output, which keep its "
      "orders apart)");
}

TEST(ValidateSchedule, WantsTolerancesThatTellALoadFromAnother) {
  for (const auto& [key, value, most] : {std::tuple{"torque_tolerance", "60 %", "50 %"},
                                         {"speed_tolerance", "51 %", "50 %"},
                                         {"tolerance_dwell", "1 min", "10 s"}}) {
    const std::string line = std::string(key) + ": " + value;
    EXPECT_EQ(MessageOf(GoodWith("    output_torque: 40 Nm", "    output_torque: 40 Nm\n    " + line)),
              "small.yaml:28:" + std::to_string(std::string(key).size() + 7) + ": error: " + key + " = " +
                  value + " would credit a load that is not there (expected at most " + most + ")");
  }
}

TEST(ValidateSchedule, WarnsThatAGearCoolsBelowTheRoom) {
  EXPECT_EQ(
      WarningsOf(GoodWith("cycles: 3", "suspend:\n  resume_temperature: 15 degC\ncycles: 3")),
      "small.yaml:24:23: warning: resume_temperature = 15 degC may be below the room's own temperature, so "
      "that a suspended gear never comes down to it (expected at least 25 degC, or a climate chamber)\n");
}

TEST(ValidateSchedule, WantsThresholdsInOrder) {
  EXPECT_EQ(
      MessageOf(GoodWith("cycles: 3",
                         "suspend:\n  trip_temperature: 60 degC\n  resume_temperature: 65 degC\n"
                         "cycles: 3")),
      "small.yaml:25:23: error: resume_temperature = 65 degC is above trip_temperature = 60 degC (line 24)");
  EXPECT_EQ(MessageOf(GoodWith("cycles: 3", "suspend:\n  trip_temperature: 75 degC\ncycles: 3")),
            "small.yaml:24:21: error: trip_temperature = 75 degC is not below gear_temperature = 75 degC "
            "(line 20)");
  EXPECT_EQ(MessageOf(GoodWith("declared_temperature: 45 degC", "declared_temperature: 72 degC")),
            "small.yaml:34:25: error: declared_temperature = 72 degC is above trip_temperature = 70 degC "
            "(default)");
}

TEST(ValidateSchedule, WantsStopCriteriaThatSomethingMeasures) {
  const std::string text = GoodWith("  - kind: transmission_error\n    input_speed: 300 rpm\n", "");
  EXPECT_EQ(MessageOf(text + "stop:\n  e_max_above: 3 arcmin\n"),
            "small.yaml:34:16: error: e_max_above is never measured (expected a transmission_error phase)");
  EXPECT_EQ(MessageOf(GoodSchedule() + "stop:\n  vibration_rms_above: 30 m/s2\n"),
            "small.yaml:36:24: error: vibration_rms_above is never measured (expected a measurement_rotation "
            "phase)");
  EXPECT_EQ(
      MessageOf(GoodSchedule() + "stop:\n  k2_below_share_of_first: 120 %\n"),
      "small.yaml:36:28: error: k2_below_share_of_first = 120 % would stop at once (expected below 100 %)");
}

TEST(ValidateSchedule, WantsTheBlankInThePreparation) {
  EXPECT_EQ(MessageOf(GoodWith("kind: hysteresis", "kind: blank_test")),
            "small.yaml:29:11: error: kind = blank_test is in the cycle (expected in preparation: a person "
            "mounts the "
            "blank)");
}

TEST(ValidateSchedule, WarnsOfACycleThatMeasuresOrLoadsNothing) {
  std::string text = GoodWith("  - kind: hysteresis\n    peak_torque: 34 Nm\n", "");
  text = With(text, "  - kind: transmission_error\n    input_speed: 300 rpm\n", "");
  EXPECT_EQ(
      WarningsOf(text),
      "small.yaml:24:1: warning: no phase measures anything (measurement_rotation, transmission_error or "
      "hysteresis)\n");
  EXPECT_EQ(WarningsOf(GoodWith("  - kind: load_run\n    duration: 30 min\n    output_torque: 40 Nm\n"
                                "    input_speed: 2400 rpm\n",
                                "")),
            "small.yaml:24:1: warning: no phase loads the gear (load_run)\n");
}

TEST(ValidateSchedule, ChecksAScheduleThatCameFromNoFile) {
  Schedule schedule = ParseSchedule(GoodSchedule(), "small.yaml");
  schedule.origins.clear();
  schedule.specimen.t1_Nm = 26.0;
  const FindingList findings = ValidateSchedule(schedule);
  ASSERT_EQ(findings.items().size(), 1U);
  EXPECT_EQ(findings.items()[0].message, "t1 = 26 is above t2 = 25 (SI)");
}

}  // namespace
}  // namespace strainwave::schedules::validate_schedule_test
