// SPDX-License-Identifier: Apache-2.0
// Record in, value out: from the samples of a window to the result with its intervals and alarms, on one
// core. Run: taskset -c 0 build/benchmarks/monitor_benchmark
#include <algorithm>
#include <chrono>
#include <vector>

#include <benchmark/benchmark.h>

#include "analysis/networks/design.h"
#include "bench/monitor/window_judge.h"
#include "tests/bench/exported_helpers.h"

namespace strainwave::bench {
namespace {

// The channels and the rate of the simulated bench, and features of every kind: more than any training keeps.
FeatureRecipe PaperRecipe(std::size_t samples) {
  FeatureRecipe recipe{
      .wavelet = {},
      .channels = {"accel_x_m_per_s2", "accel_y_m_per_s2", "accel_z_m_per_s2", "accel_motor_z_m_per_s2"},
      .sample_rate_hz = 25600.0,
      .least_samples = samples,
      .inputs = {}};
  constexpr std::size_t kInputs = 204;
  const auto names = analysis::features::WaveletFeatures(recipe.wavelet).Names(recipe.channels);
  for (const std::string& name : names) {
    const bool same_for_all = name.find("langevin") != std::string::npos;
    if (!same_for_all && recipe.inputs.size() < kInputs) recipe.inputs.push_back(name);
  }
  return recipe;
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
  std::vector<double> time_ms;
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    benchmark::DoNotOptimize(judge.Judge(window).distance);
    time_ms.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  std::ranges::sort(time_ms);
  const auto share = [&](double part) {
    return time_ms[static_cast<std::size_t>(part * static_cast<double>(time_ms.size() - 1))];
  };
  state.counters["p50_ms"] = share(0.5);
  state.counters["p99_ms"] = share(0.99);
  state.counters["most_ms"] = time_ms.back();
}
BENCHMARK(JudgesAWindow)->Arg(51'200)->Arg(102'400)->Iterations(1000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace strainwave::bench
