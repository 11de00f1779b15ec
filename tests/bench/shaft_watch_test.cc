// SPDX-License-Identifier: Apache-2.0
#include "bench/safety/shaft_watch.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "analysis/units.h"

namespace strainwave::bench::shaft_watch_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr nanoseconds kPeriod = milliseconds(10);

// A shaft with the drive's own position and the encoder's, told every 10 ms, until the watch finds fault.
struct Shaft {
  double speed_rad_per_s{RadPerSFromRpm(1000.0)};
  nanoseconds drive_late{};  // what it tells was true so much earlier
  std::function<double(double)> encoder = [](double angle_rad) { return angle_rad; };
  std::function<nanoseconds(nanoseconds)> drive_time = [](nanoseconds time) { return time; };
  bool tells_position{true};

  struct Found {
    StopReason reason;
    nanoseconds after{};
  };
  Found TurnFor(nanoseconds most, double encoder_step_rad = 0.0) const {
    ShaftWatch watch(encoder_step_rad);
    for (nanoseconds time = kPeriod; time <= most; time += kPeriod) {
      const nanoseconds told = drive_time(time);
      Readings readings;
      readings.time = readings.input_angle_time = time;
      readings.input_angle_rad = encoder(AngleAt(time));
      const DriveActual driving{.time = told,
                                .position_rad = AngleAt(told - drive_late),
                                .tells_position = tells_position,
                                .speed_rad_per_s = speed_rad_per_s};
      if (const StopReason reason = watch.Check(readings, driving)) return {reason, time};
    }
    return {};
  }

 private:
  double AngleAt(nanoseconds time) const {
    return speed_rad_per_s * std::chrono::duration<double>(time).count();
  }
};

TEST(ShaftWatch, LetsAnEncoderGoWithItsShaftWhereverTheTwoBegan) {
  Shaft shaft;
  shaft.drive_late = milliseconds(15);
  shaft.encoder = [](double angle_rad) { return angle_rad + 3.0; };
  EXPECT_FALSE(shaft.TurnFor(std::chrono::seconds(10)).reason);
}

TEST(ShaftWatch, FindsAStuckEncoderWithinTheTimeAtEverySpeedAndSaysHowFar) {
  for (const double speed_rpm : {-3000.0, -10.0, 5.0, 300.0, 3000.0}) {
    Shaft shaft;
    shaft.speed_rad_per_s = RadPerSFromRpm(speed_rpm);
    shaft.encoder = [](double) { return 1.0; };
    const Shaft::Found found = shaft.TurnFor(std::chrono::seconds(2));
    EXPECT_EQ(found.reason.cause, StopCause::kInputAngleApart) << speed_rpm;
    EXPECT_LT(found.after, milliseconds(350)) << speed_rpm;
    EXPECT_LT(speed_rpm * found.reason.value, 0.0) << speed_rpm;
  }
}

TEST(ShaftWatch, FindsAnEncoderThatSlips) {
  Shaft shaft;
  shaft.encoder = [](double angle_rad) { return 0.99 * angle_rad; };
  const Shaft::Found found = shaft.TurnFor(std::chrono::seconds(10));
  EXPECT_EQ(found.reason.cause, StopCause::kInputAngleApart);
  EXPECT_EQ(Describe(found.reason).substr(0, 24), "the input angle went -13");
}

TEST(ShaftWatch, BearsTheStepsOfACoarseEncoder) {
  constexpr double kStep_rad = kTwoPi / 60.0;
  Shaft shaft;
  shaft.speed_rad_per_s = RadPerSFromRpm(1.0);
  shaft.encoder = [](double angle_rad) { return kStep_rad * std::floor(angle_rad / kStep_rad); };
  EXPECT_FALSE(shaft.TurnFor(std::chrono::seconds(60), kStep_rad).reason);
  EXPECT_TRUE(shaft.TurnFor(std::chrono::seconds(60), 0.0).reason);
}

// A drive that is asked once in a period of a swing, always at a turning point, and tells where it was half a
// period ago: seen at the end of a rotation behind a slow serial line.
TEST(ShaftWatch, LetsAShaftSwingThatHasComeToStand) {
  ShaftWatch watch(0.0);
  constexpr double kSwing_rad = RadFromDeg(1.3);
  constexpr nanoseconds kSwingPeriod = milliseconds(80);
  const auto phase = [](nanoseconds time) {
    return kTwoPi * static_cast<double>(time.count()) /
           static_cast<double>(milliseconds(80) / nanoseconds(1));
  };
  for (nanoseconds time = kPeriod; time <= std::chrono::seconds(5); time += kPeriod) {
    const nanoseconds told = time - time % kSwingPeriod;
    Readings readings;
    readings.time = readings.input_angle_time = time;
    // The first of all is told before anything swings.
    const double swing_rad = told < milliseconds(400) ? 0.0 : kSwing_rad;
    readings.input_angle_rad = swing_rad * std::cos(phase(time));
    readings.input_speed_rad_per_s = -swing_rad * std::sin(phase(time)) * phase(std::chrono::seconds(1));
    const DriveActual driving{.time = told,
                              .position_rad = swing_rad * std::cos(phase(told - kSwingPeriod / 2)),
                              .tells_position = true};
    ASSERT_FALSE(watch.Check(readings, driving)) << time.count() << " ns";
  }
}

TEST(ShaftWatch, DoesNotJudgeADriveThatIsHeldUp) {
  Shaft shaft;
  // For four seconds in five nothing new comes from it; then it is heard five times.
  shaft.drive_time = [](nanoseconds time) {
    const nanoseconds in_turn = time % std::chrono::seconds(5);
    return in_turn < milliseconds(50) ? time : time - in_turn + milliseconds(40);
  };
  shaft.encoder = [](double) { return 0.0; };
  EXPECT_FALSE(shaft.TurnFor(std::chrono::seconds(12)).reason);
  EXPECT_TRUE(shaft.TurnFor(std::chrono::seconds(60)).reason);
}

TEST(ShaftWatch, JudgesNoDriveThatTellsNoPosition) {
  Shaft shaft;
  shaft.tells_position = false;
  EXPECT_FALSE(shaft.TurnFor(std::chrono::seconds(10)).reason);
}

TEST(ShaftWatch, BeginsAnewWhereAPhaseBegins) {
  ShaftWatch watch(0.0);
  Readings readings;
  DriveActual driving;
  const auto check = [&](double encoder_rad) {
    readings.input_angle_time = driving.time += kPeriod;
    readings.input_angle_rad = encoder_rad;
    return watch.Check(readings, driving);
  };
  for (int i = 0; i < 100; ++i) ASSERT_FALSE(check(0.0));
  watch.Restart();
  // The drive was homed, say.
  for (int i = 0; i < 100; ++i) ASSERT_FALSE(check(5.0));
}

TEST(ShaftWatch, JudgesNothingTwice) {
  // The drive, or the encoder, tells the same sample again: of another moment than the other's new one.
  for (const bool drive_repeats : {true, false}) {
    ShaftWatch watch(0.0);
    Readings readings;
    DriveActual driving{.time = kPeriod, .position_rad = 0.0, .tells_position = true, .speed_rad_per_s = 0.0};
    readings.time = readings.input_angle_time = kPeriod;
    EXPECT_FALSE(watch.Check(readings, driving));
    for (nanoseconds time = 2 * kPeriod; time < std::chrono::seconds(2); time += kPeriod) {
      readings.time = time;
      (drive_repeats ? readings.input_angle_time : driving.time) = time;
      readings.input_angle_rad = 100.0;
      EXPECT_FALSE(watch.Check(readings, driving));
    }
  }
}

TEST(ShaftWatch, JudgesNoSamplesThatAreFarApartInTime) {
  Shaft shaft;
  shaft.drive_time = [](nanoseconds time) { return time + milliseconds(60); };
  shaft.encoder = [](double) { return 0.0; };
  EXPECT_FALSE(shaft.TurnFor(std::chrono::seconds(5)).reason);
}

}  // namespace
}  // namespace strainwave::bench::shaft_watch_test
