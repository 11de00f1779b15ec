// SPDX-License-Identifier: Apache-2.0
#include "schedules/reader/plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "tests/schedules/schedule_text.h"

namespace strainwave::schedules::plan_test {
namespace {

using std::chrono::system_clock;

constexpr double kHour_s = 3600.0;
constexpr double kRounding = 1e-9;
const system_clock::time_point kStart = std::chrono::sys_days{std::chrono::year{2026} / 3 / 1};

Schedule LoadOnly(int cycles) {
  Schedule schedule = ParseSchedule(GoodSchedule(), "small.yaml");
  schedule.cycles = cycles;
  schedule.measurements.repeatability_repeats = 0;
  schedule.phases.resize(1);
  return schedule;
}

TEST(MakePlan, CountsHalfAnHourAcross3500CyclesAs1750Hours) {
  EXPECT_NEAR(MakePlan(LoadOnly(3500), kStart).load_s, 1750.0 * kHour_s, kRounding);
}

TEST(MakePlan, AddsFiftyEightHoursForAMinuteOfMeasuringACycle) {
  Schedule schedule = LoadOnly(3500);
  const Plan without = MakePlan(schedule, kStart);
  // 0 → T → −T → T → 0 is six times the peak: 30 Nm at 3 Nm/s take 60 s.
  HysteresisTest minute;
  minute.peak_torque_Nm = 30.0;
  minute.torque_rate_Nm_per_s = 3.0;
  minute.lock_angles_rad = {0.0};
  schedule.phases.push_back({"minute", minute, 0});
  const Plan with = MakePlan(schedule, kStart, {.brake_s = 0.0, .lock_move_s = 0.0});
  EXPECT_NEAR(with.measuring_s / kHour_s, 58.3333333, 1e-6);
  EXPECT_NEAR(with.wall_s - without.wall_s, 3500.0 * 60.0, 1e-6);
  EXPECT_EQ(with.load_s, without.load_s);
}

TEST(MakePlan, KeepsLoadMeasuringAndOtherTimeApart) {
  const Plan plan = MakePlan(ParseSchedule(GoodSchedule(), "small.yaml"), kStart);
  ASSERT_EQ(plan.phases.size(), 3U);
  EXPECT_EQ(plan.phases[0].load_s, 1800.0);
  EXPECT_EQ(plan.phases[0].measuring_s, 0.0);
  EXPECT_NEAR(plan.phases[0].other_s, 1.0, kRounding);  // 40 Nm down at 40 Nm/s; the speed takes 0.25 s
  EXPECT_EQ(plan.phases[1].load_s, 0.0);
  EXPECT_NEAR(plan.phases[1].measuring_s, 6.0 * 34.0 / 3.0 + 4.0 * 0.5, kRounding);
  EXPECT_NEAR(plan.wall_s, plan.load_s + plan.measuring_s + plan.other_s, kRounding);
  // 3 cycles, and 5 repeats of the measurements.
  EXPECT_NEAR(plan.load_s, 3.0 * 1800.0, kRounding);
  EXPECT_NEAR(plan.measuring_s, 8.0 * (plan.phases[1].measuring_s + plan.phases[2].measuring_s), 1e-6);
}

TEST(MakePlan, TimesASweepStepByStep) {
  const Plan plan = MakePlan(ParseSchedule(GoodSchedule(), "small.yaml"), kStart);
  // 1° of the output is 80° of the input: 1.396 rad at 31.4 rad/s and 1000 rad/s² are 0.0444 s + 0.0314 s,
  // eight periods of 10 ms. The approach of 5° is 0.254 s, 26 periods. 361 readings of 0.15 s in either
  // direction.
  EXPECT_NEAR(plan.phases[2].measuring_s, 2.0 * (360.0 * 0.08 + 2.0 * 0.26 + 361.0 * 0.15), kRounding);
}

TEST(MakePlan, ExpectsTheEndAfterTheWallTime) {
  const Plan plan = MakePlan(LoadOnly(48), kStart);
  EXPECT_EQ(plan.start, kStart);
  EXPECT_EQ(std::chrono::floor<std::chrono::seconds>(plan.expected_end - kStart).count(), 48 * 1801);
}

TEST(MakePlan, DoesNotOverflowInCampaignsOfManyLives) {
  Schedule schedule = LoadOnly(10'000'000);
  std::get<LoadRun>(schedule.phases[0].parameters).duration_s = 1e300;
  const Plan plan = MakePlan(schedule, kStart);
  EXPECT_GT(plan.expected_end, kStart);
  EXPECT_LE(plan.expected_end,
            system_clock::time_point{std::chrono::sys_days{std::chrono::year{2200} / 1 / 1}});
  EXPECT_GT(plan.disk_bytes, 0U);
}

TEST(MakePlan, CarriesLoadBlocksWithTheMeanSpeedOverReversals) {
  const Plan plan = MakePlan(LoadOnly(1), kStart);
  ASSERT_EQ(plan.cycle_load_blocks.size(), 1U);
  const LoadBlock& block = plan.cycle_load_blocks[0];
  EXPECT_EQ(block.output_torque_Nm, 40.0);
  EXPECT_EQ(block.duration_s, 1800.0);
  // 80 input turns at 40 turns/s take 2 s, and 0.2513 s more to run up and out: 80π rad/s over 1000 rad/s².
  const double turns_per_s = 80.0 / (2.0 + 0.08 * std::numbers::pi);
  EXPECT_NEAR(block.mean_input_speed_rad_per_s, turns_per_s * 2.0 * std::numbers::pi, 1e-9);
}

TEST(MakePlan, CountsTheDiskStreamByStream) {
  Schedule schedule = LoadOnly(10);
  MeasurementRotation rotation;
  rotation.input_speed_rad_per_s = 80.0 * std::numbers::pi;  // one output turn in 2 s
  rotation.input_acceleration_rad_per_s2 = 1000.0;
  schedule.phases.push_back({"rotation", rotation, 0});
  const Plan plan = MakePlan(schedule, kStart);
  ASSERT_EQ(plan.streams.size(), 3U);
  EXPECT_EQ(plan.streams[0].name, "load_run");
  EXPECT_EQ(plan.streams[0].bytes_total, 10U * 1800U * 40U);
  EXPECT_EQ(plan.streams[1].rows_per_cycle, 200U);
  EXPECT_EQ(plan.streams[2].name, "rotation/vibration");
  EXPECT_EQ(plan.streams[2].bytes_total, 10U * 51200U * 16U);
  EXPECT_EQ(plan.disk_bytes,
            plan.streams[0].bytes_total + plan.streams[1].bytes_total + plan.streams[2].bytes_total);
}

TEST(MakePlan, CountsPreparationOnceAndSaysThatASoakMayEndEarlier) {
  Schedule schedule = LoadOnly(100);
  schedule.preparation.push_back({"cool", Soak{30.0, 7200.0}, 0});
  const Plan plan = MakePlan(schedule, kStart);
  EXPECT_TRUE(plan.at_most);
  ASSERT_EQ(plan.preparation.size(), 1U);
  EXPECT_NEAR(plan.other_s, 7200.0 + 100.0 * 1.0, kRounding);
}

TEST(MoveTime, AgreesWithAMoveSteppedInSmallTimes) {
  const auto stepped_s = [](double distance, double speed, double acceleration) {
    constexpr double kStep_s = 1e-6;
    double position = 0.0, velocity = 0.0, time_s = 0.0;
    while (position < distance && velocity >= 0.0) {
      const bool braking = velocity * velocity / (2.0 * acceleration) >= distance - position;
      velocity =
          braking ? velocity - acceleration * kStep_s : std::min(speed, velocity + acceleration * kStep_s);
      position += velocity * kStep_s;
      time_s += kStep_s;
    }
    return time_s;
  };
  constexpr double kSteps_s =
      3e-4;  // the stepped move brakes up to a step late: √(2·14 rad/s·1 µs / 1000 rad/s²)
  EXPECT_NEAR(MoveTime_s(1.4, 31.4, 1000.0), stepped_s(1.4, 31.4, 1000.0), kSteps_s);
  EXPECT_NEAR(MoveTime_s(0.2, 31.4, 1000.0), stepped_s(0.2, 31.4, 1000.0), kSteps_s);  // never at full speed
}

TEST(MakePlan, ReadsAShuntWithoutAndWithIt) {
  Schedule schedule = LoadOnly(2);
  SensorCheck check;
  check.duration_s = 2.0;
  schedule.phases = {{"zero", check, 0}};
  EXPECT_EQ(MakePlan(schedule, kStart).cycle.other_s, 21.0);  // 18 s of dither, a second to settle
  check.kind = SensorCheck::Kind::kShunt;
  schedule.phases = {{"shunt", check, 0}};
  const Plan plan = MakePlan(schedule, kStart);
  EXPECT_EQ(plan.cycle.other_s, 6.0);
  EXPECT_EQ(plan.wall_s, 12.0);
  EXPECT_EQ(plan.load_s, 0.0);
  EXPECT_EQ(plan.measuring_s, 0.0);
}

}  // namespace
}  // namespace strainwave::schedules::plan_test
