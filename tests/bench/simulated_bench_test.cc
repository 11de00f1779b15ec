// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/simulated/simulated_bench.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/bench/simulated_helpers.h"

namespace strainwave::bench::simulated_bench_test {
namespace {

namespace model = analysis::model;
using protocols::PowerState;
using std::chrono::milliseconds;

bool SameBits(const Readings& a, const Readings& b) {
  return a.input_angle_rad == b.input_angle_rad && a.output_angle_rad == b.output_angle_rad &&
         a.input_speed_rad_per_s == b.input_speed_rad_per_s && a.output_torque_Nm == b.output_torque_Nm &&
         a.motor_torque_Nm == b.motor_torque_Nm && a.gear_temperature_degC == b.gear_temperature_degC &&
         a.ambient_temperature_degC == b.ambient_temperature_degC &&
         a.vibration_rms_m_per_s2 == b.vibration_rms_m_per_s2;
}

// A short load run; returns what was read.
std::vector<Readings> LoadRun(SimulatedBench& bench, double time_s) {
  Driver driver(bench);
  driver.BringUp(DriveMode::kSpeed);
  std::vector<Readings> rows;
  const int steps = static_cast<int>(time_s / 0.01);
  for (int i = 0; i < steps; ++i) {
    bench.driving_servo().CommandSpeed(std::min(200.0, 20.0 * i));
    bench.load_servo().CommandTorque(-std::min(30.0, 1.0 * i));
    driver.Steps(1);
    rows.push_back(bench.sampler().Read());
  }
  bench.driving_servo().QuickStop();
  bench.load_servo().QuickStop();
  driver.Wait(2.0);
  return rows;
}

// That the shafts turned, too: benches at rest would be the same whatever their seed.
void ExpectTheSameRun(const std::vector<Readings>& expected, const std::vector<Readings>& found,
                      double time_s) {
  ASSERT_EQ(expected.size(), static_cast<std::size_t>(time_s / 0.01));
  ASSERT_EQ(found.size(), expected.size());
  EXPECT_GT(expected.back().input_speed_rad_per_s, 190.0);  // of 200 that were commanded
  for (std::size_t i = 0; i < expected.size(); ++i) ASSERT_TRUE(SameBits(expected[i], found[i])) << i;
}

std::string MessageOf(const SimulatedBenchSettings& settings) {
  try {
    const SimulatedBench bench(model::DefaultPlantModel(), settings);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no error";
}

TEST(SimulatedBench, GivesTheSameBitsForTheSameSeedAndCalls) {
  SimulatedBench a(model::DefaultPlantModel(), {.seed = 4});
  SimulatedBench b(model::DefaultPlantModel(), {.seed = 4});
  const std::vector<Readings> run = LoadRun(a, 5.0);
  ExpectTheSameRun(run, LoadRun(b, 5.0), 5.0);
  SimulatedBench other(model::DefaultPlantModel(), {.seed = 5});
  EXPECT_FALSE(SameBits(run.back(), LoadRun(other, 5.0).back()));
}

TEST(SimulatedBench, IsAnotherSpecimenWithAnotherSeed) {
  const SimulatedBench a(model::DefaultPlantModel(), {.seed = 4});
  const SimulatedBench b(model::DefaultPlantModel(), {.seed = 5});
  EXPECT_NE(a.TruthNow(RadFromDeg(1.0), 360).k2_Nm_per_rad, b.TruthNow(RadFromDeg(1.0), 360).k2_Nm_per_rad);
}

TEST(SimulatedBench, GoesOnFromItsMemoryToTheSameBits) {
  // One bench runs two phases, another is switched on with the memory of the moment between them.
  SimulatedBench whole(model::DefaultPlantModel(), {.seed = 4});
  whole.BeginPhase(1);
  LoadRun(whole, 3.0);
  const BenchMemory memory = whole.Memory();
  whole.BeginPhase(2);
  const std::vector<Readings> expected = LoadRun(whole, 3.0);

  SimulatedBench resumed(model::DefaultPlantModel(), {.seed = 4});
  resumed.RestoreAfterPowerCut(memory);
  resumed.BeginPhase(2);
  ExpectTheSameRun(expected, LoadRun(resumed, 3.0), 3.0);
}

TEST(SimulatedBench, GoesOnToTheSameBitsAlsoStraightAfterAQuickStop) {
  // As a controller ends a phase: torque off, brakes commanded, and no time passes before the next one.
  const auto run = [](SimulatedBench& bench) {
    Driver driver(bench);
    driver.BringUp(DriveMode::kSpeed);
    bench.driving_servo().CommandSpeed(5.0);
    driver.Wait(0.5);
    bench.driving_servo().CommandSpeed(0.0);
    driver.Steps(2);
    bench.driving_servo().QuickStop();
    bench.load_servo().QuickStop();
  };
  SimulatedBench whole(model::DefaultPlantModel(), {.seed = 4});
  run(whole);
  const BenchMemory memory = whole.Memory();
  whole.BeginPhase(2);
  Driver(whole).Wait(2.0);
  SimulatedBench resumed(model::DefaultPlantModel(), {.seed = 4});
  resumed.RestoreAfterPowerCut(memory);
  resumed.BeginPhase(2);
  Driver(resumed).Wait(2.0);
  EXPECT_TRUE(SameBits(whole.sampler().Read(), resumed.sampler().Read()));
}

TEST(SimulatedBench, IsAtRestWithTorqueOffAndBrakesOnAfterAPowerCutAtFullLoad) {
  SimulatedBench bench(model::DefaultPlantModel(), {.seed = 4});
  Driver driver(bench);
  driver.BringUp(DriveMode::kSpeed);
  bench.driving_servo().CommandSpeed(250.0);
  bench.load_servo().CommandTorque(-40.0);
  driver.Wait(1.0);
  SimulatedBench resumed(model::DefaultPlantModel(), {.seed = 4});
  resumed.RestoreAfterPowerCut(bench.Memory());
  const Readings readings = resumed.sampler().Read();
  EXPECT_NEAR(readings.input_speed_rad_per_s, 0.0, 0.5);
  EXPECT_NEAR(readings.output_torque_Nm, 0.0, 3.0);
  EXPECT_TRUE(resumed.driving_servo().Actual().brake_engaged);
  EXPECT_TRUE(resumed.load_servo().Actual().brake_engaged);
  EXPECT_NE(resumed.driving_servo().Actual().power, PowerState::kOperationEnabled);
  EXPECT_EQ(resumed.clock().Now().count(), 0);
  EXPECT_GE(resumed.Memory().plant.time_s, bench.Memory().plant.time_s);
}

TEST(SimulatedBench, ShowsTheSameNoiseWhenAPhaseIsRunAgain) {
  SimulatedBench bench(model::DefaultPlantModel(), {.seed = 4});
  Driver driver(bench);
  const auto noise = [&](std::uint64_t key) {
    bench.BeginPhase(key);
    driver.Steps(1);
    return bench.sampler().Read().output_torque_Nm;
  };
  const double first = noise(7);
  EXPECT_NE(noise(8), first);
  EXPECT_NEAR(noise(7), first, 1e-9);  // but for the room's temperature, some steps later
}

TEST(SimulatedBench, ReadsOnceAPeriod) {
  SimulatedBench bench(model::DefaultPlantModel(), {.seed = 4});
  Driver(bench).Steps(1);
  EXPECT_TRUE(SameBits(bench.sampler().Read(), bench.sampler().Read()));
}

TEST(SimulatedBench, TurnsATimeSkewIntoATransmissionError) {
  // docs/effects.md E20: 1 ms at 1000 rpm is 4.5 arcmin, and the sign follows the direction.
  const auto error_arcmin = [](double skew_s, double speed_rpm) {
    SimulatedBench bench(PerfectlyMeasured(), {.seed = 4, .time_skew_s = skew_s});
    Driver driver(bench);
    driver.BringUp(DriveMode::kSpeed);
    bench.driving_servo().CommandSpeed(RadPerSFromRpm(speed_rpm));
    driver.Wait(2.0);
    const Readings readings = bench.sampler().Read();
    return ArcminFromRad(readings.input_angle_rad / 80.0 - readings.output_angle_rad);
  };
  EXPECT_NEAR(error_arcmin(1e-3, 1000.0) - error_arcmin(0.0, 1000.0), -4.5, 0.1);
  EXPECT_NEAR(error_arcmin(1e-3, -1000.0) - error_arcmin(0.0, -1000.0), 4.5, 0.1);
  EXPECT_NEAR(60.0 * (error_arcmin(10e-6, 1000.0) - error_arcmin(0.0, 1000.0)), -2.7, 0.1);
}

TEST(SimulatedBench, MeasuresItsOwnTruthInASweep) {
  SimulatedBench bench(PerfectlyMeasured(), {.seed = 6, .time_skew_s = 0.0});
  Driver driver(bench);
  driver.BringUp(DriveMode::kPosition);
  driver.MoveTo(-8.0);
  double lowest = 0.0;
  double highest = 0.0;
  double sum = 0.0;
  double start = 0.0;
  for (int step = 0; step < 360; ++step) {
    driver.MoveTo(80.0 * RadFromDeg(step));
    const Readings readings = bench.sampler().Read();
    const double error = readings.input_angle_rad / 80.0 - readings.output_angle_rad;
    if (step == 0) start = error;
    lowest = std::min(lowest, error - start);
    highest = std::max(highest, error - start);
    sum += error - start;
  }
  const BenchTruth truth = bench.TruthNow(RadFromDeg(1.0), 360, 0.0);
  EXPECT_NEAR(highest - lowest, truth.e_max_rad, 0.015 * truth.e_max_rad);
  EXPECT_NEAR(sum / 360.0, truth.e_avg_rad, 0.015 * truth.e_max_rad);
  EXPECT_GT(ArcminFromRad(truth.e_max_rad), 0.6);
  EXPECT_LT(ArcminFromRad(truth.e_max_rad), 1.4);
}

TEST(SimulatedBench, LosesMotionBetweenTheDirections) {
  const auto at_zero = [](double from_rad) {
    SimulatedBench bench(PerfectlyMeasured(), {.seed = 6, .time_skew_s = 0.0});
    Driver driver(bench);
    driver.BringUp(DriveMode::kPosition);
    for (const double target : {from_rad, 0.0}) driver.MoveTo(target);
    const Readings readings = bench.sampler().Read();
    return readings.input_angle_rad / 80.0 - readings.output_angle_rad;
  };
  const double lost_arcmin = ArcminFromRad(at_zero(-10.0) - at_zero(10.0));
  EXPECT_GT(lost_arcmin, 0.1);
  EXPECT_LT(lost_arcmin, 2.0);
}

TEST(SimulatedBench, ShowsTheTrueStiffnessInALockTest) {
  // The secants of the falling branch between the knees (friction shifts them by 2.3 Nm) with the known
  // series compliance taken off; two lock angles a quarter turn apart average the wave generator out.
  std::vector<double> k2;
  SimulatedBench bench(PerfectlyMeasured(), {.seed = 6, .time_skew_s = 0.0});
  Driver driver(bench);
  for (const double angle_rad : {0.0, 0.5 * kPi}) {
    driver.BringUp(DriveMode::kPosition);
    driver.MoveTo(angle_rad);
    driver.LockInput();
    double torque = 0.0;
    driver.Ramp(torque, 45.0, 2.0);
    driver.Ramp(torque, 21.0, 2.0);
    const Readings upper = bench.sampler().Read();
    driver.Ramp(torque, 6.0, 2.0);
    const Readings lower = bench.sampler().Read();
    driver.Ramp(torque, 0.0, 2.0);
    const BenchTruth truth = bench.TruthNow(RadFromDeg(1.0), 360);
    const double fall_Nm = upper.output_torque_Nm - lower.output_torque_Nm;
    const double fall_rad =
        upper.output_angle_rad - lower.output_angle_rad - fall_Nm * truth.series_compliance_rad_per_Nm;
    k2.push_back(fall_Nm / fall_rad);
  }
  const double true_k2 = bench.TruthNow(RadFromDeg(1.0), 360).k2_Nm_per_rad;
  EXPECT_GT(std::abs(k2[0] - k2[1]), 0.03 * true_k2);  // E7 is there
  EXPECT_NEAR(0.5 * (k2[0] + k2[1]), true_k2, 0.006 * true_k2);
}

TEST(SimulatedBench, RepeatsFrozenChannelsAndFlagsDeadOnes) {
  SimulatedBench bench(model::DefaultPlantModel(), {.seed = 4});
  Driver driver(bench);
  driver.BringUp(DriveMode::kSpeed);
  bench.driving_servo().CommandSpeed(50.0);
  driver.Wait(0.5);
  const Readings before = bench.sampler().Read();
  constexpr unsigned kTorque = 1u << static_cast<unsigned>(Channel::kOutputTorque);
  constexpr unsigned kAngle = 1u << static_cast<unsigned>(Channel::kOutputAngle);
  bench.Inject({.frozen_channels = kTorque, .dead_channels = kAngle});
  driver.Steps(3);
  const Readings after = bench.sampler().Read();
  EXPECT_EQ(after.output_torque_Nm, before.output_torque_Nm);
  EXPECT_EQ(after.output_angle_rad, before.output_angle_rad);
  EXPECT_NE(after.input_angle_rad, before.input_angle_rad);
  EXPECT_EQ(after.bad_channels, kAngle);
  bench.Inject({.sampler_silent = true});
  driver.Steps(3);
  EXPECT_EQ(bench.sampler().Read().time, after.time);
  bench.Inject({});
  driver.Steps(1);
  EXPECT_EQ(bench.sampler().Read().bad_channels, 0u);
  EXPECT_EQ(bench.sampler().Read().time, bench.clock().Now());
}

TEST(SimulatedBench, FaultsADriveOnDemandAndHeatsTheGear) {
  SimulatedBench bench(model::DefaultPlantModel(), {.seed = 4});
  Driver driver(bench);
  driver.BringUp(DriveMode::kSpeed);
  bench.Inject({.driving_fault = true, .gear_temperature_degC = 77.0});
  driver.Steps(2);
  EXPECT_EQ(bench.driving_servo().Actual().power, PowerState::kFault);
  EXPECT_EQ(bench.load_servo().Actual().power, PowerState::kOperationEnabled);
  EXPECT_NEAR(bench.sampler().Read().gear_temperature_degC, 77.0, 0.3);
}

TEST(SimulatedBench, CountsOverrunsAndKeepsItsTime) {
  SimulatedBench bench(model::DefaultPlantModel(), {.seed = 4});
  bench.clock().SleepUntil(milliseconds(10));
  bench.clock().SleepUntil(milliseconds(5));
  EXPECT_EQ(bench.clock().Overruns(), 1u);
  EXPECT_EQ(bench.clock().Now(), milliseconds(10));
}

TEST(SimulatedBench, ComesToTheSameTemperaturesInAnyStepLength) {
  std::vector<double> temperatures;
  for (const int period_ms : {10, 20, 50}) {
    SimulatedBench bench(model::DefaultPlantModel(), {.seed = 4});
    Driver driver(bench, milliseconds(period_ms));
    driver.BringUp(DriveMode::kSpeed);
    bench.driving_servo().CommandSpeed(250.0);
    bench.load_servo().CommandTorque(-40.0);
    driver.Wait(900.0);
    temperatures.push_back(bench.Memory().plant.thermal.gear_degC);
  }
  EXPECT_GT(temperatures[0], 30.0);
  EXPECT_NEAR(temperatures[1], temperatures[0], 0.2);
  EXPECT_NEAR(temperatures[2], temperatures[0], 0.2);
}

TEST(SimulatedBench, StartsAtTheAmbientThatIsAskedFor) {
  const SimulatedBench bench(ModelWithout({"day_and_night"}), {.seed = 4, .ambient_degC = 31.0});
  EXPECT_EQ(bench.Memory().plant.thermal.gear_degC, 31.0);
}

TEST(SimulatedBench, RejectsSettingsThatCannotBe) {
  EXPECT_EQ(MessageOf({.pace = 0.0}), "pace = 0 must be above zero");
  EXPECT_EQ(MessageOf({.time_skew_s = INFINITY}), "time_skew_s = inf must be finite");
}

}  // namespace
}  // namespace strainwave::bench::simulated_bench_test
