// SPDX-License-Identifier: Apache-2.0
// Every way out of every phase: torque off, brakes on, within one control period, and nothing commanded
// after.
#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "bench/controller/dead_man.h"
#include "bench/controller/jog_program.h"
#include "bench/controller/make_program.h"
#include "bench/controller/standstill_programs.h"
#include "bench/controller/unwind_program.h"
#include "tests/simulation/bench_fixture.h"

namespace strainwave::bench::safe_state_test {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kControlPeriod{10};

struct Way {
  std::string name;
  std::function<void(SpiedBench&)> happen;
  StopCause cause;
};

const std::vector<Way>& Ways() {
  static const std::vector<Way> ways{
      {"DriveFault", [](SpiedBench& bench) { bench.machine.bench().Inject({.driving_fault = true}); },
       StopCause::kDriveFault},
      {"LoadFault", [](SpiedBench& bench) { bench.machine.bench().Inject({.load_fault = true}); },
       StopCause::kDriveFault},
      {"DrivingDropsOut", [](SpiedBench& bench) { bench.driving.dropped_out = true; },
       StopCause::kDriveDroppedOut},
      {"LoadDropsOut", [](SpiedBench& bench) { bench.load.dropped_out = true; }, StopCause::kDriveDroppedOut},
      {"DrivingSilent", [](SpiedBench& bench) { bench.driving.silent = true; }, StopCause::kDriveSilent},
      {"LoadSilent", [](SpiedBench& bench) { bench.load.silent = true; }, StopCause::kDriveSilent},
      {"SilentSampler", [](SpiedBench& bench) { bench.machine.bench().Inject({.sampler_silent = true}); },
       StopCause::kStaleReadings},
      {"DeadTorqueChannel",
       [](SpiedBench& bench) {
         bench.machine.bench().Inject({.dead_channels = 1u << static_cast<unsigned>(Channel::kOutputTorque)});
       },
       StopCause::kImplausibleReading},
      {"Overheated", [](SpiedBench& bench) { bench.machine.bench().Inject({.gear_temperature_degC = 90.0}); },
       StopCause::kGearTemperatureLimit},
      {"QuickStop", [](SpiedBench& bench) { bench.request = StopRequest::kQuickStop; },
       StopCause::kQuickStopRequested},
      {"Shutdown", [](SpiedBench& bench) { bench.request = StopRequest::kShutdown; },
       StopCause::kShutdownRequested},
      {"FullDisk", [](SpiedBench& bench) { bench.runner.EndForFullDisk(); }, StopCause::kDiskFull},
  };
  return ways;
}

struct PhaseCase {
  std::string name;
  schedules::PhaseParameters parameters;
};

const std::vector<PhaseCase>& PhaseCases() {
  static const std::vector<PhaseCase> phases{{"LoadRun", TestLoadRun(60.0)},
                                             {"Rotation", TestRotation()},
                                             {"Sweep", TestSweep()},
                                             {"Hysteresis", TestHysteresis()}};
  return phases;
}

class SafeState : public testing::TestWithParam<std::tuple<std::size_t, std::size_t>> {};

TEST_P(SafeState, IsReachedWithinOneControlPeriodAndTheCauseIsNamed) {
  const PhaseCase& phase = PhaseCases()[std::get<0>(GetParam())];
  const Way& way = Ways()[std::get<1>(GetParam())];
  SpiedBench bench;
  const auto program = MakeProgram(phase.parameters, TestSpecimen(), 0.0, 0.01);
  int beats = 0;
  const PhaseOutcome outcome = bench.runner.Run(*program, [&](const PhaseSnapshot&, const PhaseProgram&) {
    if (++beats == 1) way.happen(bench);
  });
  // With the input locked the driving servo is off, until it goes on to the next angle.
  const bool is_off = phase.name == "Hysteresis" && way.name == "DrivingDropsOut";
  EXPECT_EQ(outcome.reason.cause, is_off ? StopCause::kDriveNotReady : way.cause) << Describe(outcome.reason);
  EXPECT_TRUE(bench.Safe());
  EXPECT_EQ(bench.driving.set_points_after_stop, 0);
  EXPECT_EQ(bench.load.set_points_after_stop, 0);
  if (IsFault(way.cause)) {
    // The stop follows the reading that broke the limit within one period; a stop that was ramped down to on
    // request takes the ramp's time.
    EXPECT_LE(bench.driving.quick_stop_at - outcome.reason.time,
              way.cause == StopCause::kStaleReadings ? 5 * kControlPeriod : kControlPeriod);
    ASSERT_EQ(outcome.black_box.size(), 1u);
  }
}

INSTANTIATE_TEST_SUITE_P(OfEveryPhase, SafeState,
                         testing::Combine(testing::Range<std::size_t>(0, 4),
                                          testing::Range<std::size_t>(0, 11)),
                         [](const auto& instance) {
                           return PhaseCases()[std::get<0>(instance.param)].name +
                                  Ways()[std::get<1>(instance.param)].name;
                         });

TEST(SafeStateOnAStuckInputEncoder, IsReachedWhenTheInputTurns) {
  for (const PhaseCase& phase : PhaseCases()) {
    SpiedBench bench;
    const auto program = MakeProgram(phase.parameters, TestSpecimen(), 0.0, 0.01);
    std::chrono::nanoseconds stuck_since{};
    const PhaseOutcome outcome = bench.runner.Run(*program, [&](const PhaseSnapshot&, const PhaseProgram&) {
      if (stuck_since.count() != 0) return;
      stuck_since = bench.devices.clock.Now();
      bench.machine.bench().Inject({.frozen_channels = 1u << static_cast<unsigned>(Channel::kInputAngle)});
    });
    EXPECT_TRUE(bench.Safe()) << phase.name;
    EXPECT_EQ(outcome.reason.cause, StopCause::kInputAngleApart) << phase.name;
    // With the input locked nothing turns, and nothing is wrong, until it goes on to the next angle.
    if (phase.name == "Hysteresis") continue;
    EXPECT_LT(outcome.reason.time - stuck_since, std::chrono::seconds(1)) << phase.name;
  }
}

TEST(SafeStateOnException, IsReachedBeforeTheExceptionLeaves) {
  SpiedBench bench;
  const auto program = MakeProgram(TestLoadRun(60.0), TestSpecimen(), 0.0, 0.01);
  EXPECT_THROW(bench.runner.Run(*program, [](const PhaseSnapshot&,
                                             const PhaseProgram&) { throw std::runtime_error("disk full"); }),
               std::runtime_error);
  EXPECT_TRUE(bench.Safe());
}

TEST(SafeStateAtPowerUp, IsEnteredBeforeAnyPhase) {
  SpiedBench bench;
  EXPECT_TRUE(bench.Safe());
  EXPECT_GE(bench.driving.quick_stop_at.count(), 0);
}

TEST(SafeStateAfterAPhase, HoldsWhenItEndedWell) {
  for (const PhaseCase& phase : PhaseCases()) {
    schedules::PhaseParameters parameters = phase.parameters;
    if (auto* run = std::get_if<schedules::LoadRun>(&parameters)) run->duration_s = 5.0;
    SpiedBench bench;
    const auto program = MakeProgram(parameters, TestSpecimen(), 0.0, 0.01);
    const PhaseOutcome outcome = bench.runner.Run(*program, NoHeartbeat);
    EXPECT_FALSE(outcome.reason) << phase.name << ": " << Describe(outcome.reason);
    EXPECT_TRUE(bench.Safe()) << phase.name;
  }
}

TEST(BringUp, GivesUpOnADriveThatNeverGetsEnabled) {
  for (const PhaseCase& phase : PhaseCases()) {
    SpiedBench bench;
    bench.load.ignores_enable = true;
    const auto program = MakeProgram(phase.parameters, TestSpecimen(), 0.0, 0.01);
    const PhaseOutcome outcome = bench.runner.Run(*program, NoHeartbeat);
    EXPECT_EQ(Describe(outcome.reason),
              "the load servo did not reach operation enabled with its brake off within 3.0 s")
        << phase.name;
    EXPECT_TRUE(bench.Safe()) << phase.name;
  }
}

TEST(FirstOut, TellsTheFirstCauseFromWhatFollowed) {
  RunnerSettings settings = TestSettings();
  settings.limits.output_torque_Nm = 30.0;
  SpiedBench bench(settings);
  const auto program = MakeProgram(TestLoadRun(60.0), TestSpecimen(), 0.0, 0.01);
  int beats = 0;
  const PhaseOutcome outcome = bench.runner.Run(*program, [&](const PhaseSnapshot&, const PhaseProgram&) {
    if (++beats == 1) bench.machine.bench().Inject({.gear_temperature_degC = 80.0});
  });
  // Forty Nm are asked for and thirty allowed: that came first, well before the first heartbeat.
  EXPECT_EQ(outcome.reason.cause, StopCause::kOutputTorqueLimit);
  EXPECT_EQ(beats, 0);
  for (const StopReason& followed : outcome.followed) EXPECT_NE(followed.cause, outcome.reason.cause);
}

TEST(FirstOut, KeepsTheSamplesBeforeAndAfter) {
  SpiedBench bench;
  const auto program = MakeProgram(TestLoadRun(60.0), TestSpecimen(), 0.0, 0.01);
  int beats = 0;
  const PhaseOutcome outcome = bench.runner.Run(*program, [&](const PhaseSnapshot&, const PhaseProgram&) {
    if (++beats == 20) bench.machine.bench().Inject({.load_fault = true});
  });
  ASSERT_EQ(outcome.black_box.size(), 1u);
  const auto time_s = outcome.black_box.front().record.Doubles("time_s");
  const double stop_s = std::chrono::duration<double>(outcome.reason.time).count();
  EXPECT_NEAR(time_s.front(), stop_s - 9.0, 0.1);  // ten seconds in all, one of them after the stop
  EXPECT_NEAR(time_s.back(), stop_s + 1.0, 0.1);
}

TEST(Pause, WaitsForTheEndOfAMeasurementAndCutsALoadRun) {
  SpiedBench bench;
  bench.request = StopRequest::kPause;
  const auto sweep = MakeProgram(TestSweep(), TestSpecimen(), 0.0, 0.01);
  EXPECT_FALSE(bench.runner.Run(*sweep, NoHeartbeat).reason);
  bench.request = StopRequest::kNone;
  const auto run = MakeProgram(TestLoadRun(60.0), TestSpecimen(), 0.0, 0.01);
  const PhaseOutcome outcome = bench.runner.Run(*run, [&](const PhaseSnapshot& now, const PhaseProgram&) {
    if (now.credited_load_s > 20.0) bench.request = StopRequest::kPause;
  });
  EXPECT_EQ(outcome.reason.cause, StopCause::kPauseRequested);
  EXPECT_GT(outcome.credited_load_s, 20.0);
  EXPECT_LT(outcome.credited_load_s, 22.0) << "a heartbeat a second, and the way down from 2400 rpm";
  EXPECT_EQ(outcome.records.size(), 1u);
  EXPECT_TRUE(bench.Safe());
}

TEST(LoadRun, ServesWhatIsLeftAndNoMore) {
  SpiedBench bench;
  const auto program = MakeProgram(TestLoadRun(60.0), TestSpecimen(), 45.0, 0.01);
  const auto start = bench.devices.clock.Now();
  const PhaseOutcome outcome = bench.runner.Run(*program, NoHeartbeat);
  EXPECT_FALSE(outcome.reason);
  EXPECT_NEAR(outcome.credited_load_s, 60.0, 1.1 * 0.01) << "a control period";
  const double took_s = std::chrono::duration<double>(bench.devices.clock.Now() - start).count();
  EXPECT_GE(took_s, 15.0);
  EXPECT_LE(took_s, 19.0);  // ramps, brakes, and parking: at most half a turn of the output, 1 s at 2400 rpm
}

TEST(Suspend, GoesOnByItselfWhenTheGearHasCooledDown) {
  RunnerSettings settings = TestSettings();
  settings.suspend.trip_temperature_degC = 60.0;
  settings.suspend.resume_temperature_degC = 50.0;
  SpiedBench bench(settings);
  const auto program = MakeProgram(TestLoadRun(60.0), TestSpecimen(), 0.0, 0.01);
  const PhaseOutcome outcome = bench.runner.Run(*program, [&](const PhaseSnapshot& now, const PhaseProgram&) {
    if (now.credited_load_s > 10.0) bench.machine.bench().Inject({.gear_temperature_degC = 65.0});
  });
  EXPECT_EQ(outcome.reason.cause, StopCause::kTemperatureSuspend);
  EXPECT_TRUE(bench.Safe());
  EXPECT_FALSE(bench.runner.WaitUntilRecovered(NoHeartbeat));
  EXPECT_LT(bench.devices.sampler.Read().gear_temperature_degC, 50.5) << "50, and the sensor's noise";
}

TEST(Suspend, ThatGivesUpSaysWhatDidNotComeBack) {
  RunnerSettings settings = TestSettings();
  settings.suspend.trip_temperature_degC = 60.0;
  settings.suspend.resume_temperature_degC = 15.0;  // the room has 20
  settings.suspend.give_up_s = 4.0 * 3600.0;
  SpiedBench bench(settings);
  const StopReason reason = bench.runner.WaitUntilRecovered(NoHeartbeat);
  EXPECT_EQ(
      Describe(reason),
      "the gear did not cool below 15 degC in 4 h (suspend.resume_temperature, suspend.give_up): is the room "
      "cooler than that?");
  EXPECT_TRUE(bench.Safe());
  EXPECT_TRUE(IsFault(reason.cause));
}

TEST(Reference, TellsALostZeroFromShaftsThatWereTurned) {
  SpiedBench bench;
  const auto said = [&](double torque_Nm, double output_deg) {
    ReferencingProgram program({5.0, RadFromDeg(0.5)}, 80.0, 0.0);
    Readings readings;
    readings.output_torque_Nm = torque_Nm;
    readings.output_angle_rad = RadFromDeg(output_deg);
    EXPECT_EQ(program.Step(readings, 1.0, bench.devices), StepResult::kFailedCheck);
    return Describe(program.failed_check());
  };
  EXPECT_EQ(
      said(17.24, 0.0),
      "at rest, with both torques off, the transducer shows 17.2 Nm (at most 5.0 Nm), also after the load "
      "servo has let go of the gear: it has lost its zero, or a shaft is clamped");
  EXPECT_EQ(
      said(0.0, 3.0),
      "at rest, input and output encoder are -3.000 deg of the output from where they were left (at most "
      "0.500 deg): somebody has turned a shaft or its coupling, or an encoder counts anew");
}

TEST(Reference, UnwindsAGearThatWasBrakedUnderLoad) {
  SpiedBench bench;
  // The input's brake stays on; the load's comes on under torque.
  const auto wait = [&](double torque_Nm) {
    for (int period = 0; period < 100; ++period) {
      if (bench.load.Actual().power == protocols::PowerState::kOperationEnabled) {
        bench.load.CommandTorque(torque_Nm);
      }
      bench.devices.clock.SleepUntil(bench.devices.clock.Now() + kControlPeriod);
    }
  };
  bench.load.Enable(DriveMode::kTorque);
  wait(0.0);
  bench.load.SetBrake(false);
  wait(20.0);
  bench.load.SetBrake(true);
  wait(20.0);
  bench.load.QuickStop();
  wait(0.0);
  ReferencingProgram before({2.0, RadFromDeg(0.5)}, TestSpecimen().ratio, std::nan(""));
  ASSERT_EQ(bench.runner.Run(before, NoHeartbeat).reason.cause, StopCause::kTorqueAtRest);
  const auto driving_enabled_at = bench.driving.enabled_at;
  UnwindProgram unwind(2.0);
  EXPECT_FALSE(bench.runner.Run(unwind, NoHeartbeat).reason);
  EXPECT_TRUE(bench.Safe());
  EXPECT_EQ(bench.driving.enabled_at, driving_enabled_at);
  ReferencingProgram after({2.0, RadFromDeg(0.5)}, TestSpecimen().ratio, std::nan(""));
  EXPECT_FALSE(bench.runner.Run(after, NoHeartbeat).reason);
}

// A hand that is on the key from one time to another, again and again; then it ends.
class Jog : public testing::TestWithParam<JogDrive> {
 protected:
  JogProgram Program(double speed_rad_per_s) {
    return JogProgram({GetParam(), speed_rad_per_s, 20.0, 0.01}, [this](std::chrono::nanoseconds now) {
      const bool held = (now > milliseconds(1000) && now < milliseconds(4000)) ||
                        (now > milliseconds(6000) && now < milliseconds(9000));
      // The period in which it lets go is the drives' own.
      if (held != was_held_) {
        changed_ = now;
      } else if (!held && now - changed_ > 2 * kControlPeriod) {
        EXPECT_TRUE(bench_.Safe()) << now.count();
        EXPECT_EQ(Turning().set_points_after_stop, 0);
      }
      was_held_ = held;
      if (now > milliseconds(2900) && now < milliseconds(2920))
        held_speed_ = Turning().Actual().speed_rad_per_s;
      if (now > milliseconds(10'000)) bench_.request = StopRequest::kShutdown;
      return held;
    });
  }
  SpyDrive& Turning() { return GetParam() == JogDrive::kDriving ? bench_.driving : bench_.load; }

  SpiedBench bench_;
  bool was_held_{};
  std::chrono::nanoseconds changed_{};
  double held_speed_{};
};
INSTANTIATE_TEST_SUITE_P(OfEither, Jog, testing::Values(JogDrive::kDriving, JogDrive::kLoad));

TEST_P(Jog, TurnsAsLongAsItIsHeldAndIsSafeOtherwise) {
  const bool driving = GetParam() == JogDrive::kDriving;
  const double speed = driving ? -2.0 : -0.1;
  JogProgram program = Program(speed);
  const PhaseOutcome outcome = bench_.runner.Run(program, NoHeartbeat);
  EXPECT_EQ(outcome.reason.cause, StopCause::kShutdownRequested) << Describe(outcome.reason);
  EXPECT_TRUE(bench_.Safe());
  // At one moment; cogging and friction of the input, times the ratio, move the load servo's speed more.
  EXPECT_NEAR(held_speed_, speed, (driving ? 0.2 : 0.4) * std::abs(speed));
  const Readings readings = bench_.devices.sampler.Read();
  const double turned_rad = driving ? readings.input_angle_rad : readings.output_angle_rad;
  // Twice three seconds, less the way up: what the load servo turns has to be torn loose through the gear.
  EXPECT_LT(turned_rad / speed, driving ? 6.0 : 6.5);
  EXPECT_GT(turned_rad / speed, 0.5 * 6.0);
}

TEST_P(Jog, IsSafeWhenADriveIsLostWhileItTurns) {
  JogProgram program = Program(0.05);
  const PhaseOutcome outcome = bench_.runner.Run(program, [&](const PhaseSnapshot& now, const PhaseProgram&) {
    if (now.readings.time > milliseconds(2500)) bench_.machine.bench().Inject({.load_fault = true});
  });
  EXPECT_EQ(outcome.reason.cause, StopCause::kDriveFault);
  EXPECT_LT(outcome.reason.time, milliseconds(4000));
  EXPECT_TRUE(bench_.Safe());
}

TEST(DeadManKey, IsGoodForAWhileAndNoLonger) {
  DeadMan hand(milliseconds(500));
  EXPECT_FALSE(hand.IsHeld(milliseconds(0)));
  hand.Hold(milliseconds(1000));
  EXPECT_TRUE(hand.IsHeld(milliseconds(1499)));
  EXPECT_FALSE(hand.IsHeld(milliseconds(1500)));
  hand.Hold(milliseconds(1500));
  hand.Release();
  EXPECT_FALSE(hand.IsHeld(milliseconds(1501)));
}

TEST(Shunt, IsTakenOffHoweverItsCheckEnds) {
  SpiedBench bench;
  schedules::SensorCheck check;
  check.kind = schedules::SensorCheck::Kind::kShunt;
  check.expected_Nm = 50.0;
  check.duration_s = 5.0;
  const auto program = MakeProgram(check, TestSpecimen(), 0.0, 0.01);
  double highest_Nm = 0.0;
  const PhaseOutcome outcome = bench.runner.Run(*program, [&](const PhaseSnapshot& now, const PhaseProgram&) {
    highest_Nm = std::max(highest_Nm, now.readings.output_torque_Nm);
    if (highest_Nm > 40.0) bench.request = StopRequest::kQuickStop;
  });
  EXPECT_EQ(outcome.reason.cause, StopCause::kQuickStopRequested);
  EXPECT_GT(highest_Nm, 40.0) << "the shunt was on";
  EXPECT_LT(std::abs(bench.devices.sampler.Read().output_torque_Nm), 1.0);
  EXPECT_TRUE(bench.Safe());
}

}  // namespace
}  // namespace strainwave::bench::safe_state_test
