// SPDX-License-Identifier: Apache-2.0
// Record in, value out: from the samples of a window to the result with its intervals and alarms, on one
// core. Run: taskset -c 0 build/benchmarks/monitor_benchmark
#include <algorithm>
#include <chrono>
#include <ctime>
#include <vector>

#include <benchmark/benchmark.h>

#include "analysis/networks/design.h"
#include "bench/monitor/window_judge.h"
#include "bench/prediction/exported_predictor.h"
#include "tests/bench/exported_helpers.h"

namespace strainwave::bench {
namespace {

// The channels and the rate of the simulated bench, and features of every kind: more than any training keeps.
FeatureRecipe PaperRecipe(std::size_t samples) {
  FeatureRecipe recipe{
      .features = {},
      .channels = {"accel_x_m_per_s2", "accel_y_m_per_s2", "accel_z_m_per_s2", "accel_motor_z_m_per_s2"},
      .sample_rate_hz = 25600.0,
      .window = {},
      .least_samples = samples,
      .inputs = {}};
  constexpr std::size_t kInputs = 204;
  const auto names = analysis::features::WaveletFeatures(recipe.features.wavelet).Names(recipe.channels);
  for (const std::string& name : names) {
    const bool same_for_all = name.find("langevin") != std::string::npos;
    if (!same_for_all && recipe.inputs.size() < kInputs) recipe.inputs.push_back(name);
  }
  return recipe;
}

double CpuTime_ms() {
  timespec time{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

double ShareOf(std::vector<double>& values, double part) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

void JudgesAWindow(benchmark::State& state) {
  const auto samples = static_cast<std::size_t>(state.range(0));
  const FeatureRecipe recipe = PaperRecipe(samples);
  const TestFolder folder;
  auto design = analysis::networks::DesignOf("ann", static_cast<int>(recipe.inputs.size()), 2);
  ExportPredictor(TestPredictor(recipe, design, 1), folder.path());
  ExportedPredictor predictor(folder.path());
  WindowJudge judge(predictor, {});
  VibrationWindow window{.sample_rate_hz = recipe.sample_rate_hz,
                         .channels = recipe.channels,
                         .samples = TestSignals(recipe.channels.size(), samples, 3),
                         .origin = "benchmark",
                         .fault = std::nullopt};
  // The time on the clock, and that of the processor alone, which other programs on the core do not lengthen.
  std::vector<double> time_ms;
  std::vector<double> cpu_ms;
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    const double cpu_start_ms = CpuTime_ms();
    benchmark::DoNotOptimize(judge.Judge(window).distance);
    cpu_ms.push_back(CpuTime_ms() - cpu_start_ms);
    time_ms.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  state.counters["p50_ms"] = ShareOf(time_ms, 0.5);
  state.counters["p99_ms"] = ShareOf(time_ms, 0.99);
  state.counters["most_ms"] = ShareOf(time_ms, 1.0);
  state.counters["p99_cpu_ms"] = ShareOf(cpu_ms, 0.99);
}
BENCHMARK(JudgesAWindow)->Arg(51'200)->Arg(102'400)->Iterations(1000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace strainwave::bench
