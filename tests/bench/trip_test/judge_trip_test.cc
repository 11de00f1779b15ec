// SPDX-License-Identifier: Apache-2.0
#include <chrono>

#include <gtest/gtest.h>

#include "bench/trip_test/trip_test.h"

namespace strainwave::bench::judge_trip_test {
namespace {

using std::chrono::milliseconds;

TripRow FaultOfTheLoad() {
  TripRow row;
  row.cause = StopCause::kDriveFault;
  row.servo = BenchServo::kLoad;
  row.noticed_within_s = 0.04;
  row.safe_within_s = 1.04;
  return row;
}

TripObservation Tripped(milliseconds ordered, milliseconds safe) {
  TripObservation seen;
  seen.reason = {StopCause::kDriveFault, 0.0, 0.0, milliseconds(500), BenchServo::kLoad};
  seen.times.provoked = milliseconds(500);
  seen.times.ordered = milliseconds(500) + ordered;
  seen.times.safe_since = milliseconds(500) + safe;
  seen.waited_s = 1.04;
  seen.as_expected = true;
  return seen;
}

TEST(JudgeTrip, PassesWhatTrippedAndStoodInTime) {
  const TripResult result = JudgeTrip(FaultOfTheLoad(), Tripped(milliseconds(40), milliseconds(1040)));
  EXPECT_EQ(result.verdict, TripVerdict::kPassed);
  EXPECT_EQ(result.seen, "tripped after 40 ms, safe after 1040 ms");
  EXPECT_EQ(result.stopped_as, "drive_fault");
  EXPECT_NEAR(result.tripped_after_s.value(), 0.04, 1e-12);
  EXPECT_NEAR(result.safe_after_s.value(), 1.04, 1e-12);
}

TEST(JudgeTrip, FailsALateTripAndALateStandstill) {
  EXPECT_EQ(JudgeTrip(FaultOfTheLoad(), Tripped(milliseconds(41), milliseconds(900))).verdict,
            TripVerdict::kFailed);
  EXPECT_EQ(JudgeTrip(FaultOfTheLoad(), Tripped(milliseconds(40), milliseconds(1041))).verdict,
            TripVerdict::kFailed);
}

TEST(JudgeTrip, FailsWhatNothingStopped) {
  TripObservation seen = Tripped(milliseconds(2000), milliseconds(2100));
  seen.reason = {};
  seen.as_expected = false;
  const TripResult result = JudgeTrip(FaultOfTheLoad(), seen);
  EXPECT_EQ(result.verdict, TripVerdict::kFailed);
  EXPECT_EQ(result.seen, "not tripped within 1040 ms");
  EXPECT_EQ(result.stopped_as, "");
  EXPECT_EQ(result.tripped_after_s, std::nullopt);
}

TEST(JudgeTrip, FailsAStopOfAnotherCauseAndSaysWhich) {
  TripObservation seen = Tripped(milliseconds(10), milliseconds(300));
  seen.reason = {StopCause::kStaleReadings, 0.031, 0.03, milliseconds(500)};
  seen.as_expected = false;
  const TripResult result = JudgeTrip(FaultOfTheLoad(), seen);
  EXPECT_EQ(result.verdict, TripVerdict::kFailed);
  EXPECT_EQ(
      result.seen,
      "tripped after 10 ms as stale_readings, safe after 300 ms: no fresh readings for 31 ms (at most 30 "
      "ms)");
}

TEST(JudgeTrip, FailsShaftsThatAreNotSafe) {
  TripObservation seen = Tripped(milliseconds(10), milliseconds(300));
  seen.times.safe_since = std::nullopt;
  const TripResult result = JudgeTrip(FaultOfTheLoad(), seen);
  EXPECT_EQ(result.verdict, TripVerdict::kFailed);
  EXPECT_EQ(result.seen, "tripped after 10 ms, not safe within 2040 ms");
}

TEST(JudgeTrip, CountsFromTheOrderWhereAPersonChoseTheMoment) {
  TripObservation seen = Tripped(milliseconds(9000), milliseconds(9400));
  seen.moment_is_known = false;
  const TripResult result = JudgeTrip(FaultOfTheLoad(), seen);
  EXPECT_EQ(result.verdict, TripVerdict::kPassed);
  EXPECT_EQ(result.seen, "tripped, safe after 400 ms");
  EXPECT_EQ(result.tripped_after_s, std::nullopt);
  seen.times.safe_since = milliseconds(500 + 9000 + 1001);
  EXPECT_EQ(JudgeTrip(FaultOfTheLoad(), seen).verdict, TripVerdict::kFailed);
}

TEST(IsAbout, AsksForTheServoAndTheChannelToo) {
  const TripRow row = FaultOfTheLoad();
  EXPECT_TRUE(IsAbout(row, {StopCause::kDriveFault, 0.0, 0.0, {}, BenchServo::kLoad}));
  EXPECT_FALSE(IsAbout(row, {StopCause::kDriveFault, 0.0, 0.0, {}, BenchServo::kDriving}));
  EXPECT_FALSE(IsAbout(row, {StopCause::kDriveSilent, 0.0, 0.0, {}, BenchServo::kLoad}));
  TripRow channel;
  channel.cause = StopCause::kImplausibleReading;
  channel.channel = Channel::kOutputTorque;
  EXPECT_TRUE(IsAbout(channel, {StopCause::kImplausibleReading, 3.0}));
  EXPECT_FALSE(IsAbout(channel, {StopCause::kImplausibleReading, 1.0}));
}

}  // namespace
}  // namespace strainwave::bench::judge_trip_test
