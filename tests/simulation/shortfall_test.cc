// SPDX-License-Identifier: Apache-2.0
// Servos that stay enabled and give less than they are asked for: no load is credited that was not there, and
// no phase is measured at another load than its own.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "bench/campaign/load_results.h"
#include "bench/controller/load_check_program.h"
#include "bench/controller/make_program.h"
#include "tests/simulation/bench_fixture.h"

namespace strainwave::bench::shortfall_test {
namespace {

double ResultOf(const PhaseOutcome& outcome, const std::string& quantity) {
  std::vector<NamedRecord> records = outcome.records;
  for (NamedRecord& named : records) named.group = "load_run/" + named.group;
  for (const Result& result : LoadResults(records)) {
    if (result.quantity == quantity) return result.value;
  }
  return std::nan("");
}

// A period of the control loop at either end of what is credited.
constexpr double kTwoPeriods_s = 2.0 * 0.01;
// Of the output torque, two per turn of the input (docs/effects.md E14), and what the transducer adds.
constexpr double kGearRipple_Nm = 4.2;

TEST(Shortfall, OfTorqueIsNoLoadAndEndsALoadRun) {
  SpiedBench bench;
  bench.load.share = 0.2;
  const auto program = MakeProgram(TestLoadRun(60.0), TestSpecimen(), 0.0, 0.01);
  const PhaseOutcome outcome = bench.runner.Run(*program, NoHeartbeat);
  EXPECT_EQ(outcome.reason.cause, StopCause::kTorqueAway) << Describe(outcome.reason);
  EXPECT_NEAR(std::abs(outcome.reason.limit), 40.0, 1e-9);
  EXPECT_NEAR(std::abs(outcome.reason.value), 0.2 * 40.0, kGearRipple_Nm);
  EXPECT_EQ(outcome.credited_load_s, 0.0);
  EXPECT_EQ(ResultOf(outcome, "load_run_credited_s"), 0.0);
  EXPECT_TRUE(bench.Safe());
}

TEST(Shortfall, OfSpeedIsNoLoadAndEndsALoadRun) {
  SpiedBench bench;
  bench.driving.share = 0.25;
  const auto program = MakeProgram(TestLoadRun(60.0), TestSpecimen(), 0.0, 0.01);
  const PhaseOutcome outcome = bench.runner.Run(*program, NoHeartbeat);
  EXPECT_EQ(outcome.reason.cause, StopCause::kSpeedAway) << Describe(outcome.reason);
  // Over the time of the encoder's low-pass; the transmission error's own speed is a percent of it.
  EXPECT_NEAR(RpmFromRadPerS(std::abs(outcome.reason.value)), 0.25 * 2400.0, 0.01 * 600.0);
  EXPECT_EQ(outcome.credited_load_s, 0.0);
  EXPECT_TRUE(bench.Safe());
}

// Turned so that the ramps, 2 × 0.4 s of each way of 2.5 s, and every second way are as asked.
TEST(Shortfall, ThatComesAndGoesIsCreditedForWhatWasThere) {
  schedules::LoadRun run = TestLoadRun(60.0);
  run.turns = 4.0;
  run.tolerances.dwell_s = 1e3;
  SpiedBench bench;
  const auto program = MakeProgram(run, TestSpecimen(), 0.0, 0.01);
  double short_s = 0.0;
  const PhaseOutcome outcome = bench.runner.Run(*program, [&](const PhaseSnapshot& now, const PhaseProgram&) {
    const double time_s = std::chrono::duration<double>(now.readings.time).count();
    bench.load.share = time_s > 20.0 && time_s < 40.0 ? 0.2 : 1.0;
    if (bench.load.share < 1.0) short_s += 1.0;
  });
  EXPECT_FALSE(outcome.reason) << Describe(outcome.reason);
  EXPECT_NEAR(short_s, 20.0, 1.0) << "a heartbeat a second";
  EXPECT_NEAR(outcome.credited_load_s, 60.0, kTwoPeriods_s);
  // As long as asked, and as long again as the torque was away, with the way there and home.
  EXPECT_NEAR(std::chrono::duration<double>(bench.devices.clock.Now()).count(), 60.0 + short_s + 3.0, 3.0);
}

// With the rate that a schedule has by default the torque never stands: 2 s to the other side, a turn of 2 s.
TEST(Shortfall, OfATorqueThatOnlyRampsIsNoLoadEither) {
  for (const double share : {1.0, 0.2}) {
    schedules::LoadRun run = TestLoadRun(60.0);
    run.torque_rate_Nm_per_s = 40.0;
    SpiedBench bench;
    bench.load.share = share;
    double credited_after_10_s = 0.0;
    const auto program = MakeProgram(run, TestSpecimen(), 0.0, 0.01);
    const PhaseOutcome outcome =
        bench.runner.Run(*program, [&](const PhaseSnapshot& now, const PhaseProgram&) {
          if (now.readings.time < std::chrono::seconds(10)) credited_after_10_s = now.credited_load_s;
        });
    EXPECT_EQ(outcome.reason.cause, share < 1.0 ? StopCause::kTorqueAway : StopCause::kNone)
        << Describe(outcome.reason);
    EXPECT_NEAR(outcome.credited_load_s, share < 1.0 ? 0.0 : 60.0, kTwoPeriods_s);
    // A kill would cost a way and a heartbeat at most.
    EXPECT_GE(credited_after_10_s, share < 1.0 ? 0.0 : 5.0);
  }
}

TEST(Shortfall, OfAFullLoadIsNothing) {
  SpiedBench bench;
  const auto program = MakeProgram(TestLoadRun(30.0), TestSpecimen(), 0.0, 0.01);
  const PhaseOutcome outcome = bench.runner.Run(*program, NoHeartbeat);
  EXPECT_FALSE(outcome.reason) << Describe(outcome.reason);
  EXPECT_NEAR(outcome.credited_load_s, 30.0, kTwoPeriods_s);
  EXPECT_NEAR(ResultOf(outcome, "load_run_credited_s"), 30.0, kTwoPeriods_s);
  // Per way of 2.25 s, 0.25 of ramp each: the cube of what is missing then.
  const double equivalent_s = ResultOf(outcome, "load_run_equivalent_s");
  EXPECT_GT(equivalent_s, 0.75 * 30.0);
  EXPECT_LT(equivalent_s, 0.98 * 30.0);
}

TEST(Shortfall, OfTorqueEndsEveryMeasurementUnderLoad) {
  for (const schedules::PhaseParameters& parameters :
       {schedules::PhaseParameters(TestRotation()), schedules::PhaseParameters(TestHysteresis())}) {
    SpiedBench bench;
    bench.load.share = 0.2;
    const auto program = MakeProgram(parameters, TestSpecimen(), 0.0, 0.01);
    const PhaseOutcome outcome = bench.runner.Run(*program, NoHeartbeat);
    EXPECT_EQ(outcome.reason.cause, StopCause::kTorqueAway) << Describe(outcome.reason);
    EXPECT_TRUE(bench.Safe());
  }
}

// A loop that is over in 5 s, of which a servo at its limit is near the set point for most of the ramps.
TEST(Shortfall, OfTorqueEndsALockTestHoweverQuick) {
  for (const double share : {0.25, 0.6, 0.95}) {
    schedules::HysteresisTest quick = TestHysteresis();
    quick.torque_rate_Nm_per_s = 40.0;
    quick.hold_s = 0.1;
    SpiedBench bench;
    bench.load.share = share;
    const auto program = MakeProgram(quick, TestSpecimen(), 0.0, 0.01);
    const PhaseOutcome outcome = bench.runner.Run(*program, NoHeartbeat);
    EXPECT_EQ(outcome.reason.cause, share < 0.95 ? StopCause::kTorqueAway : StopCause::kNone)
        << share << ": " << Describe(outcome.reason);
    EXPECT_TRUE(bench.Safe());
  }
}

TEST(Shortfall, OfTorqueEndsTheDitherBeforeAZero) {
  SpiedBench bench;
  bench.load.share = 0.2;
  schedules::SensorCheck check;
  check.kind = schedules::SensorCheck::Kind::kZero;
  check.duration_s = 1.0;
  const auto program = MakeProgram(check, TestSpecimen(), 0.0, 0.01);
  const PhaseOutcome outcome = bench.runner.Run(*program, NoHeartbeat);
  EXPECT_EQ(outcome.reason.cause, StopCause::kTorqueAway) << Describe(outcome.reason);
  EXPECT_TRUE(bench.Safe());
}

TEST(Shortfall, OfSpeedEndsARotation) {
  SpiedBench bench;
  bench.driving.share = 0.25;
  const auto program = MakeProgram(TestRotation(), TestSpecimen(), 0.0, 0.01);
  const PhaseOutcome outcome = bench.runner.Run(*program, NoHeartbeat);
  EXPECT_EQ(outcome.reason.cause, StopCause::kSpeedAway) << Describe(outcome.reason);
}

TEST(LoadCheck, FindsFactorsOfOneAndComesBackToWhereItBegan) {
  SpiedBench bench;
  LoadCheckProgram program(TestSpecimen(), 0.01);
  const double before_rad = bench.devices.sampler.Read().input_angle_rad;
  const PhaseOutcome outcome = bench.runner.Run(program, NoHeartbeat);
  EXPECT_FALSE(outcome.reason) << Describe(outcome.reason);
  EXPECT_NEAR(program.torque_factor(), 1.0, 0.1);
  EXPECT_NEAR(program.speed_factor(), 1.0, 0.02);
  EXPECT_NEAR(bench.devices.sampler.Read().input_angle_rad, before_rad, RadFromDeg(2.0));
  EXPECT_TRUE(bench.Safe());
}

TEST(LoadCheck, RefusesAFactorAndASignBeforeTheGearFeelsThem) {
  for (const auto& [share, cause] : {std::pair{0.5, StopCause::kTorqueFactor},
                                     {-1.0, StopCause::kTorqueFactor},
                                     {1.5, StopCause::kTorqueFactor},
                                     {1.0 / 70.0, StopCause::kTorqueFactor},
                                     {70.0, StopCause::kTorqueOfCheck}}) {
    SpiedBench bench;
    bench.load.share = share;
    LoadCheckProgram program(TestSpecimen(), 0.01);
    double most_Nm = 0.0;
    const PhaseOutcome outcome = bench.runner.Run(program, NoHeartbeat);
    EXPECT_EQ(outcome.reason.cause, cause) << share << ": " << Describe(outcome.reason);
    for (const NamedRecord& box : outcome.black_box) {
      for (const double torque_Nm : box.record.Doubles("torque_Nm"))
        most_Nm = std::max(most_Nm, std::abs(torque_Nm));
    }
    EXPECT_LT(most_Nm, 25.0) << share;
    EXPECT_TRUE(bench.Safe());
  }
}

TEST(LoadCheck, SaysWhatIsOff) {
  SpiedBench bench;
  bench.load.share = -1.0;
  LoadCheckProgram turned(TestSpecimen(), 0.01);
  const std::string words = Describe(bench.runner.Run(turned, NoHeartbeat).reason);
  EXPECT_EQ(words.substr(0, 45), "turning slowly, the transducer shows -1.00 ti") << words;
  SpiedBench slow;
  slow.driving.share = 0.5;
  LoadCheckProgram program(TestSpecimen(), 0.01);
  EXPECT_EQ(
      Describe(slow.runner.Run(program, NoHeartbeat).reason),
      "turning slowly, the input encoder shows 0.50 times the speed that the driving servo was asked for "
      "(expected 1 ± 0.1): counts_per_rev or sign of the encoder, or the units of the drive's profile?");
}

}  // namespace
}  // namespace strainwave::bench::shortfall_test
