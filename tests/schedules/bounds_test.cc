// SPDX-License-Identifier: Apache-2.0
#include "schedules/reader/bounds.h"

#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "schedules/reader/schedule_bounds.h"
#include "tests/schedules/schedule_text.h"

namespace strainwave::schedules::bounds_test {
namespace {

constexpr Dimension kDimensions[] = {Dimension::kTime,
                                     Dimension::kAngle,
                                     Dimension::kAngularSpeed,
                                     Dimension::kAngularAcceleration,
                                     Dimension::kTorque,
                                     Dimension::kTorqueRate,
                                     Dimension::kFrequency,
                                     Dimension::kTemperature,
                                     Dimension::kTemperatureDifference,
                                     Dimension::kAcceleration,
                                     Dimension::kSensitivity,
                                     Dimension::kShare};

constexpr QuantityBound kBounds[] = {
    {"a.wait", Dimension::kTime, "1 ms", "1 min", "it is short"},
    {"wait", Dimension::kTime, "", "1 h", "it is long"},
    {"count", std::nullopt, "", "10", "there are ten"},
};

TEST(BeyondBound, TakesWhatLiesWithinAndTheBoundItself) {
  for (const double time_s : {1e-3, 1.0, 60.0})
    EXPECT_EQ(BeyondBound(kBounds, "a.wait", Dimension::kTime, time_s), "");
  EXPECT_EQ(BeyondBound(kBounds, "b.wait", Dimension::kTime, 3600.0), "");
}

TEST(BeyondBound, NamesTheBoundAndTheReason) {
  EXPECT_EQ(BeyondBound(kBounds, "a.wait", Dimension::kTime, 60.1),
            "is above 1 min (expected no more, since it is short)");
  EXPECT_EQ(BeyondBound(kBounds, "a.wait", Dimension::kTime, 0.9e-3),
            "is below 1 ms (expected no less, since it is short)");
  EXPECT_EQ(BeyondBound(kBounds, "count", std::nullopt, -11.0),
            "is below -10 (expected no less, since there are ten)");
}

TEST(BeyondBound, GoesByTheEndOfThePathAndTheDimension) {
  EXPECT_EQ(BeyondBound(kBounds, "list[3].a.wait", Dimension::kTime, 61.0),
            "is above 1 min (expected no more, since it is short)");
  EXPECT_EQ(BeyondBound(kBounds, "a[12].wait", Dimension::kTime, 61.0),
            "is above 1 min (expected no more, since it is short)");
  EXPECT_EQ(BeyondBound(kBounds, "await", Dimension::kTime, 1e5), "");
  EXPECT_EQ(BeyondBound(kBounds, "a.wait", Dimension::kAngle, 61.0), "");
  EXPECT_EQ(BeyondBound(kBounds, "wait[1]", Dimension::kTime, 3601.0),
            "is above 1 h (expected no more, since it is long)");
}

TEST(BeyondBound, BoundsEveryDimensionAndPlainNumbers) {
  for (const Dimension dimension : kDimensions) {
    for (const double sign : {-1.0, 1.0}) {
      EXPECT_NE(BeyondBound({}, "a", dimension, sign * 1e10), "") << DimensionName(dimension);
    }
  }
  EXPECT_EQ(BeyondBound({}, "a", std::nullopt, 2e15),
            "is above 1e15 (expected no more, since no number of a bench is larger)");
}

TEST(ScheduleBounds, AreReadableInTheirOwnUnits) {
  ASSERT_FALSE(ScheduleBounds().empty());
  for (const QuantityBound& bound : ScheduleBounds()) {
    EXPECT_NO_THROW((void)BeyondBound(ScheduleBounds(), bound.path, bound.dimension, 1e-9)) << bound.path;
    EXPECT_NE(BeyondBound(ScheduleBounds(), bound.path, bound.dimension, 1e14), "") << bound.path;
    EXPECT_FALSE(bound.reason.empty()) << bound.path;
  }
}

std::string GoodWith(std::string_view from, std::string_view to) { return With(GoodSchedule(), from, to); }

TEST(ScheduleBounds, RefuseWhatWouldLeaveTheBenchUnwatched) {
  const std::pair<std::string_view, std::string_view> kSuspend[] = {
      {"bad_sensor: 1000 h",
       "bad_sensor = 1000 h is above 1 min (expected no more, since the load goes on meanwhile, and nothing "
       "is known "
       "of what the channel watches)"},
      {"bad_sensor: 61 s",
       "bad_sensor = 61 s is above 1 min (expected no more, since the load goes on meanwhile, and nothing is "
       "known of "
       "what the channel watches)"},
      {"give_up: 8 d",
       "give_up = 8 d is above 7 d (expected no more, since a bench that has stood for so long needs a "
       "person)"},
      {"dwell: 25 h", "dwell = 25 h is above 24 h (expected no more, since a gear is cold by then)"},
  };
  for (const auto& [line, message] : kSuspend) {
    const std::string text = GoodWith("cycles: 3", "suspend:\n  " + std::string(line) + "\ncycles: 3");
    EXPECT_EQ(MessageOf(text),
              "small.yaml:24:" + std::to_string(line.find(' ') + 4) + ": error: " + std::string(message));
  }
  EXPECT_EQ(MessageOf(GoodWith("cycles: 3", "suspend:\n  bad_sensor: 60 s\n  give_up: 7 d\ncycles: 3")), "");
}

TEST(ScheduleBounds, RefuseLimitsThatNothingReaches) {
  EXPECT_EQ(
      MessageOf(GoodWith("gear_temperature: 75 degC", "gear_temperature: 7500 degC")),
      "small.yaml:20:21: error: gear_temperature = 7500 degC is above 150 degC (expected no more, since the "
      "grease, seals and bearings of such a gear bear no more)");
  EXPECT_EQ(MessageOf(GoodWith("vibration_rms: 50 m/s2", "vibration_rms: 60 g")),
            "small.yaml:21:18: error: vibration_rms = 60 g is above 500 m/s2 (expected no more, since "
            "accelerometers of "
            "the usual 50 g show no more)");
  EXPECT_EQ(
      MessageOf(GoodWith("input_speed: 3000 rpm", "input_speed: 30000 rpm")),
      "small.yaml:19:16: error: input_speed = 30000 rpm is above 15000 rpm (expected no more, since no wave "
      "generator is made for more)");
  EXPECT_EQ(MessageOf(GoodWith("twist: 30 arcmin", "twist: 30 deg")),
            "small.yaml:22:10: error: twist = 30 deg is above 5 deg (expected no more, since teeth have "
            "jumped by then)");
}

// A tooth of 160 is 135 arcmin of the output.
TEST(ScheduleBounds, RefuseATwistAtWhichTeethHaveJumped) {
  EXPECT_EQ(MessageOf(GoodWith("twist: 30 arcmin", "twist: 67 arcmin")), "");
  EXPECT_EQ(MessageOf(GoodWith("twist: 30 arcmin", "twist: 68 arcmin")),
            "small.yaml:22:10: error: twist = 68 arcmin is not below half a tooth, 67.5 arcmin with "
            "flexspline_teeth = "
            "160 (expected less, since teeth have jumped by then)");
}

TEST(ScheduleBounds, GoForEachItemOfAListAndForPlainNumbers) {
  EXPECT_EQ(
      MessageOf(GoodWith("peak_torque: 34 Nm", "peak_torque: 34 Nm\n    lock_angles: [0 deg, 101 rev]")),
      "small.yaml:31:26: error: lock_angles[1] = 101 rev is above 100 rev (expected no more, since the error "
      "of "
      "an encoder comes back each turn)");
  EXPECT_EQ(MessageOf(GoodWith("duration: 30 min", "duration: 30 min\n    turns: 1e-6")),
            "small.yaml:27:12: error: turns = 1e-6 is below 0.001 (expected no less, since the output "
            "reverses after "
            "each)");
}

TEST(ScheduleBounds, APhaseMustBeAbleToEnd) {
  EXPECT_EQ(MessageOf(GoodWith("input_speed: 300 rpm", "input_speed: 1e-9 rpm")),
            "small.yaml:32:18: error: input_speed = 1e-9 rpm is below 0.01 rpm (expected no less, since a "
            "phase must "
            "end, and no wave generator is made for more)");
  EXPECT_EQ(MessageOf(GoodWith("peak_torque: 34 Nm", "peak_torque: 34 Nm\n    torque_rate: 1e-6 Nm/s")),
            "small.yaml:31:18: error: torque_rate = 1e-6 Nm/s is below 0.001 Nm/s (expected no less, since a "
            "ramp must "
            "end, and be seen before it has passed a limit)");
}

TEST(ScheduleBounds, ASuspensionMustBeAbleToEnd) {
  EXPECT_EQ(MessageOf(GoodWith("cycles: 3", "suspend:\n  dwell: 2 h\n  give_up: 1 h\ncycles: 3")),
            "small.yaml:24:10: error: dwell = 2 h is above give_up = 1 h (line 25)");
}

}  // namespace
}  // namespace strainwave::schedules::bounds_test
