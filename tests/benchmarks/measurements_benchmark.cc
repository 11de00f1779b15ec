// SPDX-License-Identifier: Apache-2.0
// How long the evaluation of one cycle takes. Run: build/benchmarks/measurements_benchmark
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "analysis/torsional_stiffness.h"
#include "analysis/transmission_error.h"
#include "analysis/units.h"
#include "daq/csv_record.h"
#include "daq/record.h"

namespace strainwave {
namespace {

constexpr double kRatio = 80.0;
constexpr analysis::TestTorques kTorques{7.0, 25.0, 34.0};

struct LoopData {
  std::vector<double> time_s;
  std::vector<double> torque_Nm;
  std::vector<double> twist_rad;
};

// 0 → +T₃ → −T₃ → +T₃ → 0 at one rate, on a spring of one slope with a friction element, and noise.
LoopData MakeLoop(int samples) {
  constexpr double kSlope_Nm_per_rad = 2.5e4, kFriction_Nm = 1.0, kYield_rad = 2e-4;
  std::mt19937 random(1);
  std::normal_distribution<double> noise;
  LoopData loop;
  double friction_Nm = 0.0;
  double twist_rad = 0.0;
  const double end_rad = kTorques.t3_Nm / kSlope_Nm_per_rad;
  for (int i = 0; i < samples; ++i) {
    const double share = 6.0 * i / (samples - 1);
    const double target_rad = end_rad * (share < 1.0   ? share
                                         : share < 3.0 ? 2.0 - share
                                         : share < 5.0 ? share - 4.0
                                                       : 6.0 - share);
    friction_Nm = std::clamp(friction_Nm + kFriction_Nm / kYield_rad * (target_rad - twist_rad),
                             -kFriction_Nm, kFriction_Nm);
    twist_rad = target_rad;
    loop.time_s.push_back(0.02 * i);
    loop.torque_Nm.push_back(kSlope_Nm_per_rad * twist_rad + friction_Nm + 0.02 * noise(random));
    loop.twist_rad.push_back(twist_rad + RadFromArcsec(1.0) * noise(random));
  }
  return loop;
}

void FitsTheStiffness(benchmark::State& state, analysis::StiffnessMethod method) {
  const LoopData loop = MakeLoop(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        analysis::MeasureStiffness({loop.time_s, loop.torque_Nm, loop.twist_rad}, kTorques, method));
  }
}
BENCHMARK_CAPTURE(FitsTheStiffness, model, analysis::StiffnessMethod::kModel)
    ->Arg(1000)
    ->Arg(4000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(FitsTheStiffness, backbone, analysis::StiffnessMethod::kBackbone)
    ->Arg(4000)
    ->Unit(benchmark::kMillisecond);

void ComputesTheTransmissionError(benchmark::State& state) {
  std::vector<double> input_rad;
  std::vector<double> output_rad;
  for (int i = 0; i <= 360; ++i) {
    const double angle_rad = RadFromDeg(i);
    output_rad.push_back(angle_rad);
    input_rad.push_back(kRatio * (angle_rad + RadFromArcmin(0.4) * std::sin(2.0 * kRatio * angle_rad + 0.3)));
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(analysis::ComputeTransmissionError({input_rad, output_rad}, {}, kRatio));
  }
}
BENCHMARK(ComputesTheTransmissionError)->Unit(benchmark::kMillisecond);

void ReadsARecord(benchmark::State& state) {
  const LoopData loop = MakeLoop(4000);
  std::string text =
      "# kind: hysteresis\n# t1_Nm: 7\n# t2_Nm: 25\n# t3_Nm: 34\ntime_s,torque_Nm,output_angle_deg\n";
  for (std::size_t i = 0; i < loop.time_s.size(); ++i) {
    text += std::to_string(loop.time_s[i]) + "," + std::to_string(loop.torque_Nm[i]) + "," +
            std::to_string(DegFromRad(loop.twist_rad[i])) + "\n";
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(daq::ParseCsvRecord(text, "loop.csv"));
  }
}
BENCHMARK(ReadsARecord)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace strainwave
