// SPDX-License-Identifier: Apache-2.0
// What counts turns on a bench of metal goes over its end in the weeks of a campaign: encoders and drives.
#include <atomic>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "bench/campaign/runner_settings.h"
#include "bench/configuration/read_bench_file.h"
#include "bench/controller/sweep_program.h"
#include "bench/machines/device_side/device_side.h"
#include "bench/machines/field/field_machine.h"
#include "tests/checkout.h"
#include "tests/simulation/bench_fixture.h"
#include "tests/simulation/until.h"

namespace strainwave::bench::field_turns_test {
namespace {

using std::chrono::seconds;

const std::filesystem::path kBench =
    std::filesystem::path(SourceFolder()) / "tests/simulation/field/bench.yaml";

// Encoders count over at 32 bits: that of the input, with 20 bits a turn, 2048 turns from its zero either
// way.
TEST(FieldTurns, CountsOnWhereAnEncoderGoesOver) {
  FieldMachine machine(ReadBenchFile(kBench), 80.0, {});
  Sampler& sampler = machine.Devices().sampler;
  Until([&] { return sampler.Read().bad_channels == 0; });
  const Readings from = sampler.Read();
  constexpr double kFarEnough_rad = 1.5 * 2048.0 * kTwoPi;
  for (const char* const drift : {"sensor drift 0 50000", "sensor drift 0 -50000"}) {
    machine.device_side()->Do(drift);
    const double direction = std::string(drift).find('-') == std::string::npos ? 1.0 : -1.0;
    const auto end = from.angles_time() + seconds(20);  // of samples; the drift alone needs less than one
    Readings readings;
    Until([&] {
      readings = sampler.Read();
      const double way_rad = direction * (readings.input_angle_rad - from.input_angle_rad);
      return way_rad > kFarEnough_rad || readings.angles_time() > end;
    });
    EXPECT_GT(direction * (readings.input_angle_rad - from.input_angle_rad), kFarEnough_rad) << drift;
    EXPECT_NEAR(readings.output_angle_rad, from.output_angle_rad, 1e-3) << drift;
  }
}

// A campaign that goes on after a power cut finds the encoders where they stood, however often they went
// over.
TEST(FieldTurns, CountsOnFromBeforeThePowerCut) {
  constexpr double kTurnsBefore = 3500.0;  // an encoder that goes over after 4096 turns says -596 of them
  std::vector<std::byte> memory;
  {
    FieldMachine before(ReadBenchFile(kBench), 80.0, {});
    Sampler& sampler = before.Devices().sampler;
    Until([&] { return sampler.Read().bad_channels == 0; });
    before.device_side()->Do("sensor drift 0 50000");
    Until([&] { return sampler.Read().input_angle_rad > kTurnsBefore * kTwoPi; });
    before.device_side()->Do("sensor drift off");
    const std::span<const std::byte> kept = before.Memory();
    memory.assign(kept.begin(), kept.end());
  }
  FieldMachine after(ReadBenchFile(kBench), 80.0, {});
  Sampler& sampler = after.Devices().sampler;
  Until([&] { return sampler.Read().bad_channels == 0; });
  const Readings alone = sampler.Read();
  after.RestoreMemory(memory);
  const auto end = alone.angles_time() + seconds(5);
  Readings readings = alone;
  Until([&] {
    readings = sampler.Read();
    return readings.input_angle_rad > 1000.0 || readings.angles_time() > end;
  });
  EXPECT_NEAR(readings.input_angle_rad, alone.input_angle_rad + 4096.0 * kTwoPi, 1e-3);
  EXPECT_NEAR(readings.output_angle_rad, alone.output_angle_rad, 1e-3);
}

// A drive's counter goes over as well, and where it stands has nothing to do with where the encoder does: a
// sweep goes by the encoder's angles all the same.
TEST(FieldTurns, SweepsWhileTheDrivesPositionGoesOver) {
  for (const char* const position : {"drive 1 position 2147400000", "drive 1 position -2147450000"}) {
    const BenchDescription bench = ReadBenchFile(kBench);
    FieldMachine machine(bench, 80.0, {});
    Sampler& sampler = machine.Devices().sampler;
    Until([&] { return sampler.Read().bad_channels == 0; });
    machine.device_side()->Do(position);
    Until([&] { return std::abs(machine.Devices().driving.Actual().position_rad) > 1e5; });
    schedules::TransmissionErrorSweep sweep;
    sweep.step_rad = RadFromDeg(5.0);
    sweep.steps = 2;
    sweep.clockwise = sweep.counter_clockwise = true;
    sweep.input_speed_rad_per_s = RadPerSFromRpm(300.0);
    sweep.input_acceleration_rad_per_s2 = 1000.0;
    sweep.settle_s = 0.3;
    sweep.averaging_s = 0.1;
    SweepProgram program(sweep, 80.0, 0.01);
    const std::atomic<StopRequest> request{StopRequest::kNone};
    RunnerSettings settings = RunnerSettingsOf(bench);
    settings.limits = TestSettings().limits;
    settings.suspend = TestSettings().suspend;
    PhaseRunner runner(machine.Devices(), settings, request);
    const PhaseOutcome outcome = runner.Run(program, [](const PhaseSnapshot&, const PhaseProgram&) {});
    EXPECT_FALSE(outcome.reason) << position << ": " << Describe(outcome.reason);
    ASSERT_EQ(outcome.records.size(), 1U);
    const std::vector<double> input_deg = outcome.records[0].record.CopyAsDoubles("input_angle_deg");
    ASSERT_EQ(input_deg.size(), 6U) << position;
    const double asked_deg[] = {0.0, 400.0, 800.0, 800.0, 400.0, 0.0};
    for (std::size_t i = 0; i < input_deg.size(); ++i)
      EXPECT_NEAR(input_deg[i], asked_deg[i], 2.0) << position;
  }
}

}  // namespace
}  // namespace strainwave::bench::field_turns_test
