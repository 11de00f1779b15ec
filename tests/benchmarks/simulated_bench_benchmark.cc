// SPDX-License-Identifier: Apache-2.0
// What a step of the simulated bench costs. Run: build/benchmarks/simulated_bench_benchmark
#include <chrono>
#include <cmath>

#include <benchmark/benchmark.h>

#include "analysis/model/plant_model.h"
#include "bench/devices/simulated/gear_plant.h"
#include "bench/devices/simulated/simulated_bench.h"
#include "bench/devices/simulated/vibration_synthesis.h"

namespace strainwave::bench {
namespace {

namespace model = analysis::model;

PlantCommands Turning(double speed_rad_per_s, double load_Nm) {
  PlantCommands commands;
  commands.input = PlantCommands::Input::kSpeed;
  commands.input_set_point = speed_rad_per_s;
  commands.input_brake = false;
  commands.load_enabled = true;
  commands.load_torque_Nm = load_Nm;
  commands.load_brake = false;
  return commands;
}

// A load run: 10 ms steps in the quasi-static limit.
void StepsALoadRun(benchmark::State& state) {
  GearPlant plant(model::CompilePlantModel(model::DefaultPlantModel()));
  const PlantCommands commands = Turning(250.0, -40.0);
  for (auto _ : state) plant.Step(commands, 0.01);
  benchmark::DoNotOptimize(plant.state().output_rad);
}
BENCHMARK(StepsALoadRun);

// A measurement rotation: 1 ms steps, four integrated substeps each.
void StepsARotation(benchmark::State& state) {
  GearPlant plant(model::CompilePlantModel(model::DefaultPlantModel()));
  const PlantCommands commands = Turning(100.0, -20.0);
  for (auto _ : state) plant.Step(commands, 0.001);
  benchmark::DoNotOptimize(plant.state().output_rad);
}
BENCHMARK(StepsARotation);

// A lock test: torque up and down on the locked input.
void StepsALockTest(benchmark::State& state) {
  GearPlant plant(model::CompilePlantModel(model::DefaultPlantModel()));
  PlantCommands commands;
  commands.load_enabled = true;
  commands.load_brake = false;
  double time_s = 0.0;
  for (auto _ : state) {
    time_s += 0.01;
    const double share = 0.02 * time_s - std::floor(0.02 * time_s);
    commands.load_torque_Nm = 34.0 * (4.0 * std::abs(share - 0.5) - 1.0);
    plant.Step(commands, 0.01);
  }
  benchmark::DoNotOptimize(plant.state().output_rad);
}
BENCHMARK(StepsALockTest);

// What a controller's period costs: step and all slow channels.
void StepsAndReadsTheBench(benchmark::State& state) {
  SimulatedBench bench(model::DefaultPlantModel(), {});
  for (auto _ : state) {
    bench.clock().SleepUntil(bench.clock().Now() + std::chrono::milliseconds(10));
    benchmark::DoNotOptimize(bench.sampler().Read());
  }
}
BENCHMARK(StepsAndReadsTheBench);

// A millisecond of four accelerometers at 25.6 kHz.
void MakesVibration(benchmark::State& state) {
  const model::Vibration vibration;
  VibrationSynthesis synthesis(vibration, 80.0, 3);
  synthesis.Start(25600.0, 1, 0.0, 1.0);
  const model::VibrationSources sources = model::SourcesAt(vibration, {250.0, 40.0, 40.0}, {});
  VibrationBlock block;
  double angle_rad = 0.0;
  int steps = 0;
  for (auto _ : state) {
    synthesis.Advance(1e-3, angle_rad, angle_rad + 0.25, sources);
    angle_rad += 0.25;
    if (++steps % 500 == 0) {
      block = {};
      synthesis.Drain(block);
    }
  }
}
BENCHMARK(MakesVibration);

}  // namespace
}  // namespace strainwave::bench
